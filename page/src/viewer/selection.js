// Which piece is selected, by its id; the viewer, the table and the card beside the viewer show the same one.

/** Event `change`; `id` is null when nothing is selected. */
export class Selection extends EventTarget {
  constructor() {
    super();
    this.id = null;
  }

  set(id) {
    if (id === this.id) return;
    this.id = id;
    this.dispatchEvent(new Event("change"));
  }
}
