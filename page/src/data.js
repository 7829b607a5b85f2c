// What the program wrote into the page (pipeline/report_page.h).

const text = (id) => document.getElementById(id).textContent;

export const readReport = () => JSON.parse(text("report"));

/** The scene file; empty when the run kept none. */
export const readScene = () => text("scene").replaceAll("&lt;", "<").replaceAll("&amp;", "&");
