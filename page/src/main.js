import { readReport } from "./data.js";

const report = readReport();
document.title = `${report.scene} · Sunder`;
const heading = document.createElement("h1");
heading.textContent = report.scene;
document.getElementById("page").append(heading);
