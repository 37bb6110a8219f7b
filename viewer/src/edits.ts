// What the reader makes of the primitives' names, as the command that does it: a page cannot write files, a copied line can.
import type { Scene } from "./data";
import { button, make } from "./dom";

interface Entry {
  /** The name in the file. */
  name: string;
  box: HTMLInputElement;
  removed: boolean;
}

/** The command for new names: what gets a name of its own, what gets the same name as others, what goes. Empty where nothing changes. */
export function command(file: string, entries: { name: string; wanted: string; removed: boolean }[]): string {
  const words: string[] = [];
  const stays = entries.filter((entry) => !entry.removed);
  const named = new Map<string, string[]>();
  for (const { name, wanted } of stays) named.set(wanted, [...(named.get(wanted) ?? []), name]);
  for (const [wanted, [name, ...more]] of named) {
    if (more.length === 0 && name !== wanted) words.push("--rename", quoted(`${name}=${wanted}`));
  }
  for (const [wanted, names] of named) {
    if (names.length > 1) words.push("--merge", quoted(`${names.join(",")}=${wanted}`));
  }
  const gone = entries.filter((entry) => entry.removed).map((entry) => entry.name);
  if (gone.length > 0) words.push("--remove", quoted(gone.join(",")));
  if (words.length === 0) return "";
  const out = file.replace(/(\.[^./\\]*)?$/, "-edited$1");
  return ["kineme edit", quoted(file), "-o", quoted(out), ...words].join(" ");
}

/** As a shell takes it for one word. */
function quoted(word: string): string {
  return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

export class Edits {
  private readonly entries: Entry[] = [];
  private readonly line = make("code", {});
  private readonly bar: HTMLElement;

  constructor(private readonly scene: Scene, cards: HTMLElement[]) {
    for (const card of cards) this.enter(card);
    const copy = button("Copy the command", "Copy", () => void this.copied(copy));
    this.bar = make("div", { class: "edits", role: "status" }, make("span", {}, "To do so:"), this.line, copy,
      button("Undo all", "Undo all", () => this.undo()));
    this.bar.hidden = true;
    document.body.append(this.bar);
    cards[0]?.parentElement?.before(make("p", { class: "note" },
      "Not right? Rename one, give several the same name to make one of them, cross one out: the page shows the command that does so."));
  }

  private enter(card: HTMLElement): void {
    const head = card.querySelector(".head");
    const name = this.scene.primitives[Number(card.dataset.card)]?.name;
    if (!head || name === undefined) return;
    const box = make("input", { class: "name", value: name, spellcheck: "false", autocomplete: "off", "aria-label": `Name of ${name}` });
    box.title = "Give it another name; the same name for several makes one of them";
    const entry: Entry = { name, box, removed: false };
    const remove = button(`Remove ${name}`, "\u2715", () => {
      entry.removed = !entry.removed;
      this.changed();
    });
    remove.classList.add("remove");
    box.addEventListener("input", () => this.changed());
    box.addEventListener("keydown", (event) => {
      if (event.key === "Escape") box.value = name;
      if (event.key === "Enter" || event.key === "Escape") box.blur();
    });
    box.addEventListener("change", () => {
      // What `kineme edit` reads as the end of a name cannot be in one.
      box.value = box.value.replace(/[,=]/g, "-").trim() || name;
      this.changed();
    });
    head.querySelector("h3")?.replaceChildren(box);
    head.append(remove);
    this.entries.push(entry);
  }

  private changed(): void {
    const entries = this.entries.map(({ name, box, removed }) => ({ name, wanted: box.value.replace(/[,=]/g, "-").trim() || name, removed }));
    for (const { name, box, removed } of this.entries) {
      const card = box.closest(".card");
      card?.classList.toggle("removed", removed);
      const remove = card?.querySelector(".remove");
      remove?.setAttribute("aria-pressed", String(removed));
      remove?.setAttribute("title", removed ? `Keep ${name}` : `Remove ${name}`);
    }
    const line = command(this.scene.vocabulary, entries);
    this.line.textContent = line;
    this.bar.hidden = line === "";
  }

  private undo(): void {
    for (const entry of this.entries) {
      entry.box.value = entry.name;
      entry.removed = false;
    }
    this.changed();
  }

  private async copied(copy: HTMLButtonElement): Promise<void> {
    try {
      await navigator.clipboard.writeText(this.line.textContent ?? "");
      copy.textContent = "Copied";
    } catch {
      // Where the page may not write to the clipboard the reader can.
      getSelection()?.selectAllChildren(this.line);
      copy.textContent = "Selected";
    }
    setTimeout(() => (copy.textContent = "Copy"), 1500);
  }
}
