// A table of many rows: sorted by any column, a page of it at a time, rows that can be selected.
import { element } from "../dom.js";
import { count } from "../format.js";

const PAGE = 15;

const compare = (a, b) => (typeof a === "string" ? a.localeCompare(b, "en", { numeric: true }) : a - b);

/**
 * `columns`: [{ name, value(row), text(row), numeric }], the first of them names the row; `id(row)` for select; `choose(row)`
 * is called when a row is activated, `chooseLabel` says what that does.
 */
export class SortableTable {
  constructor({ caption, columns, rows, id, choose, chooseLabel, sort }) {
    Object.assign(this, { columns, id, choose, chooseLabel });
    this.rows = rows;
    this.sort = sort ?? { column: 0, down: false };
    this.page = 0;
    this.selected = null;
    this.body = element("tbody");
    this.heads = columns.map((column, i) => this.head(column, i));
    this.where = element("p", { class: "quiet", "aria-live": "polite" });
    this.pager = this.makePager();
    this.node = element(
      "div",
      { class: "card" },
      element(
        "div",
        {
          class: "table-scroll whole",
          tabindex: "0",
          role: "region",
          "aria-label": `Table of ${caption.toLowerCase()}`,
        },
        element(
          "table",
          { class: "rows" },
          element("caption", { class: "hidden-title" }, caption),
          element("thead", {}, element("tr", {}, this.heads)),
          this.body,
        ),
      ),
      this.pager,
    );
    this.order();
  }

  head(column, i) {
    const button = element("button", { type: "button", onclick: () => this.sortBy(i) }, column.name);
    return element("th", { scope: "col", class: column.numeric ? "numeric" : null }, button);
  }

  makePager() {
    const turn = (pages) => () => this.turnTo(this.page + pages);
    this.before = element("button", { type: "button", onclick: turn(-1) }, "Previous");
    this.after = element("button", { type: "button", onclick: turn(1) }, "Next");
    return element("div", { class: "pager" }, this.where, this.before, this.after);
  }

  sortBy(i) {
    this.sort = { column: i, down: this.sort.column === i ? !this.sort.down : Boolean(this.columns[i].numeric) };
    this.page = 0;
    this.order();
  }

  order() {
    const { value } = this.columns[this.sort.column];
    const sign = this.sort.down ? -1 : 1;
    this.rows = [...this.rows].sort((a, b) => sign * compare(value(a), value(b)));
    this.heads.forEach((head, i) => {
      if (i === this.sort.column) head.setAttribute("aria-sort", this.sort.down ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    });
    this.show();
  }

  turnTo(page) {
    this.page = Math.min(this.pages - 1, Math.max(0, page));
    this.show();
  }

  get pages() {
    return Math.max(1, Math.ceil(this.rows.length / PAGE));
  }

  /** Marks the row of an id and turns to its page; null: none. */
  select(id) {
    this.selected = id;
    const at = id === null ? -1 : this.rows.findIndex((row) => this.id(row) === id);
    if (at >= 0) this.page = Math.floor(at / PAGE);
    this.show();
  }

  row(row) {
    const [first, ...rest] = this.columns;
    const chosen = this.selected !== null && this.id(row) === this.selected;
    const button = element("button", { type: "button", "aria-label": this.chooseLabel(row) }, first.text(row));
    const node = element(
      "tr",
      { class: chosen ? "chosen" : null, "aria-current": chosen ? "true" : null },
      element("th", { scope: "row" }, button),
      rest.map((column) => element("td", { class: column.numeric ? "numeric" : null }, column.text(row))),
    );
    node.addEventListener("click", () => this.choose(row));
    return node;
  }

  show() {
    const begin = this.page * PAGE;
    const shown = this.rows.slice(begin, begin + PAGE);
    const focused = this.body.contains(document.activeElement)
      ? document.activeElement.getAttribute("aria-label")
      : null;
    this.body.replaceChildren(...shown.map((row) => this.row(row)));
    if (focused) this.body.querySelector(`[aria-label="${CSS.escape(focused)}"]`)?.focus();
    this.pager.hidden = this.rows.length <= PAGE;
    this.where.textContent = `${count(begin + 1)} to ${count(begin + shown.length)} of ${count(this.rows.length)}`;
    this.before.disabled = this.page === 0;
    this.after.disabled = this.page === this.pages - 1;
  }
}
