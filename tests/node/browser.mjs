// Debian's Chromium for tests of pages, drawing in software: machines that test have no graphics card.
import puppeteer from "puppeteer-core";

const GRAPHICS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];

const PATIENCE = 60_000;

export const launch = (more = GRAPHICS) =>
  puppeteer.launch({
    executablePath: "/usr/bin/chromium",
    args: ["--no-sandbox", "--hide-scrollbars", ...more],
    // Drawing in software on a busy machine takes its time.
    protocolTimeout: 600_000,
  });

// Keeps what the viewer's canvas holds when it has come to rest: once the browser has shown it, it cannot be read.
function keepPicture() {
  document.addEventListener("DOMContentLoaded", () => {
    const canvas = document.getElementById("canvas");
    const keep = () => "still" in canvas.dataset && (window.picture = canvas.toDataURL());
    new MutationObserver(keep).observe(canvas, { attributes: true, attributeFilter: ["data-still"] });
  });
}

/** Waits until the viewer drew or gave up; `window.picture`: what it shows at rest. `complaints`: of the console and of scripts; `requests`: all addresses. */
export async function openPage(browser, address, { width = 1280, scheme = "light", motion = "reduce" } = {}) {
  const page = await browser.newPage();
  const complaints = [];
  const requests = [];
  page.on("console", (message) => complaints.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(error.stack));
  page.on("request", (request) => request.url().startsWith("data:") || requests.push(request.url()));
  await page.setViewport({ width, height: Math.round(Math.min(2160, Math.max(844, 0.5625 * width))) });
  await page.emulateMediaFeatures([
    { name: "prefers-color-scheme", value: scheme },
    { name: "prefers-reduced-motion", value: motion },
  ]);
  await page.evaluateOnNewDocument(keepPicture);
  await page.goto(address);
  await page.waitForSelector("#viewer[data-ready], #viewer.no-view", { timeout: PATIENCE }).catch((error) => {
    throw new Error(`${error.message}\n${complaints.join("\n")}`);
  });
  return { page, complaints, requests };
}
