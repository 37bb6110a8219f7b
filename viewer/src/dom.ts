// Elements, made briefly.

type Children = (Node | string)[];

export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: Children
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** A button that says what it does, with a sign in place of words where the sign is known. */
export function button(label: string, sign: string, act: () => void): HTMLButtonElement {
  const element = make("button", { type: "button", title: label, "aria-label": label }, sign);
  element.addEventListener("click", act);
  return element;
}

/** A button that is on or off. */
export function toggle(label: string, sign: string, on: boolean, act: (on: boolean) => void): HTMLButtonElement {
  const element: HTMLButtonElement = button(label, sign, () => {
    on = !on;
    element.setAttribute("aria-pressed", String(on));
    act(on);
  });
  element.setAttribute("aria-pressed", String(on));
  return element;
}

/** One of several, by name: a row of them, or a list where they are many, with what leads through it. */
export class Choice {
  readonly element: HTMLElement;
  private readonly boxes: HTMLInputElement[] = [];
  private readonly list: HTMLSelectElement | null = null;
  private at = 0;

  constructor(label: string, private readonly names: string[], private readonly chosen: (i: number) => void) {
    if (names.length > 9) {
      const list = make("select", { "aria-label": label });
      names.forEach((name, i) => list.append(make("option", { value: String(i) }, name)));
      list.addEventListener("change", () => this.choose(Number(list.value)));
      this.list = list;
      this.element = make("div", { class: "choice list" }, list,
        button("Previous (P)", "\u2039", () => this.step(-1)), button("Next (N)", "\u203a", () => this.step(1)));
      return;
    }
    this.element = make("div", { class: "choice row", role: "radiogroup", "aria-label": label });
    names.forEach((name, i) => {
      const one = make("input", { type: "radio", name: label, value: String(i) });
      one.checked = i === 0;
      one.addEventListener("change", () => this.choose(i));
      this.boxes.push(one);
      this.element.append(make("label", {}, one, name));
    });
  }

  choose(i: number): void {
    this.at = i;
    if (this.list) this.list.value = String(i);
    const box = this.boxes[i];
    if (box) {
      box.checked = true;
      box.parentElement?.scrollIntoView({ block: "nearest", inline: "nearest" });
    }
    this.chosen(i);
  }

  /** The one so many further on; after the last comes the first. */
  step(by: number): void {
    this.choose((this.at + by + this.names.length) % this.names.length);
  }
}

/** Black or white, whichever reads better on a colour (relative luminance of WCAG 2.1). */
export function textOn(colour: string): string {
  const level = (at: number): number => {
    const c = parseInt(colour.slice(at, at + 2), 16) / 255;
    return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  };
  return 0.2126 * level(1) + 0.7152 * level(3) + 0.0722 * level(5) > 0.179 ? "#000" : "#fff";
}

/** A number as readers like it. */
export function short(value: number, digits = 2): string {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text.replace("-", "\u2212");
}
