// The tracks of a take over its time, with a playhead that can be dragged.
import { floats, shares, type Bands, type Line, type Spans, type Stretch, type Take } from "./data";
import { make, short, textOn } from "./dom";

const SVG = "http://www.w3.org/2000/svg";
const HEIGHT = 100;
/** Pixels that a letter of a label takes, about. */
const LETTER = 6.3;
/** Seconds between ticks that are tried, and how many pixels they should be apart. */
const STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60, 120, 300, 600];
const TICK_APART = 64;

interface Row {
  /** Says what there is at a moment. */
  now(secs: number): void;
}

/** A label that is seen where it has room. */
interface Label {
  element: HTMLElement;
  start: number;
  end: number;
  /** What it may say, the longest first. */
  texts: string[];
}

export class Timeline {
  readonly element = make("div", { class: "timeline" });
  private readonly head = make("div", { class: "playhead" });
  private readonly rows: Row[] = [];
  private readonly resized = new ResizeObserver(() => this.fit());
  private labels: Label[] = [];
  private ticks = make("div", { class: "ticks" });
  private secs = 1;

  constructor(private readonly palette: string[], private readonly put: (secs: number) => void) {
    this.element.addEventListener("pointerdown", (event) => {
      if (!(event.target as Element).closest(".lane")) return;
      this.element.setPointerCapture(event.pointerId);
      this.dragged(event);
    });
    this.element.addEventListener("pointermove", (event) => {
      if (this.element.hasPointerCapture(event.pointerId)) this.dragged(event);
    });
  }

  show(take: Take): void {
    this.secs = Math.max(take.secs, 1e-3);
    this.rows.length = 0;
    this.labels = [];
    this.resized.disconnect();
    this.element.replaceChildren();
    for (const track of take.tracks) {
      const title = make("span", { class: "track-title" }, track.title);
      const now = make("span", { class: "track-now" });
      const lane = make("div", { class: "lane" });
      this.element.append(make("div", { class: `track ${track.kind}` }, make("div", { class: "gutter" }, title, now), lane));
      if (track.kind === "spans") this.spans(track, lane, now);
      else if (track.kind === "bands") this.bands(track, lane, now);
      else this.line(track, lane, now);
    }
    if (take.tracks.length === 0) return;
    this.ticks = make("div", { class: "ticks", "aria-hidden": "true" });
    this.element.append(this.ticks, this.head);
    this.resized.observe(this.ticks);
    this.fit();
  }

  now(secs: number): void {
    this.head.style.setProperty("--at", String(secs / this.secs));
    for (const row of this.rows) row.now(secs);
  }

  private dragged(event: PointerEvent): void {
    const { left, width } = this.ticks.getBoundingClientRect();
    this.put(((event.clientX - left) / width) * this.secs);
  }

  private colour(group: number | null): string {
    return group === null ? "var(--none)" : this.palette[group % this.palette.length];
  }

  private share(secs: number): string {
    return `${(100 * secs) / this.secs}%`;
  }

  /** Labels where there is room for them, and ticks that are neither crowded nor lost. */
  private fit(): void {
    const width = this.ticks.clientWidth;
    for (const { element, start, end, texts } of this.labels) {
      const room = (width * (end - start)) / this.secs - 6;
      element.textContent = texts.find((text) => LETTER * text.length <= room) ?? "";
    }
    const step = STEPS.find((s) => (width * s) / this.secs >= TICK_APART) ?? STEPS[STEPS.length - 1];
    const marks: HTMLElement[] = [];
    for (let i = 0; i * step < this.secs - 0.35 * step; i++) {
      const mark = make("span", {}, i === 0 ? "0 s" : short(i * step, step < 1 ? 1 : 0));
      mark.style.left = this.share(i * step);
      marks.push(mark);
    }
    this.ticks.replaceChildren(...marks);
  }

  private spans(track: Spans, lane: HTMLElement, now: HTMLElement): void {
    const sorted = [...track.spans].sort((a, b) => a.start - b.start || a.end - b.end);
    // A name where there is room for it, else what tells it from the others, else nothing.
    const prefix = commonPrefix(sorted.map((span) => span.name));
    // What overlaps goes one line lower.
    const ends: number[] = [];
    const parts = sorted.map((span) => {
      let line = ends.findIndex((end) => end <= span.start + 1e-6);
      if (line < 0) line = ends.push(0) - 1;
      ends[line] = span.end;
      const part = make("div", { class: "span", title: told(span) });
      part.style.left = this.share(span.start);
      part.style.width = this.share(span.end - span.start);
      part.style.setProperty("--line", String(line));
      part.style.background = this.colour(span.colour);
      if (span.colour !== null) part.style.color = textOn(this.colour(span.colour));
      else part.classList.add("none");
      const texts = [span.name, span.name.startsWith(prefix) ? span.name.slice(prefix.length) : span.name];
      this.labels.push({ element: part, start: span.start, end: span.end, texts });
      return part;
    });
    lane.style.setProperty("--lines", String(Math.max(ends.length, 1)));
    lane.append(...parts);
    this.rows.push({
      now: (secs) => {
        const names: string[] = [];
        sorted.forEach((span, i) => {
          const on = span.start <= secs && secs < span.end;
          parts[i].classList.toggle("on", on);
          if (on) names.push(span.name);
        });
        now.textContent = names.join(", ");
      },
    });
  }

  private bands(track: Bands, lane: HTMLElement, now: HTMLElement): void {
    const values = shares(track.shares);
    const n = track.classes.length;
    const moments = Math.floor(values.length / Math.max(n, 1));
    const svg = this.svg(lane);
    const at = (i: number): number => track.start_secs + i / track.rate_hz;
    const below = new Float32Array(moments);
    const colourless = track.classes.filter((c) => c.colour === null).length;
    let faint = 0;
    track.classes.forEach((c, k) => {
      // Of several that have no colour the last is the plain one.
      const pale = c.colour === null && ++faint < colourless;
      const fill = pale ? "var(--pale)" : this.colour(c.colour);
      const above = below.map((share, i) => share + values[i * n + k]);
      for (const [from, to] of runs(moments, (i) => values[i * n + k] > 0.004)) {
        // A moment more at either side: where it begins to rise from nothing.
        const [first, last] = [Math.max(from - 1, 0), Math.min(to + 1, moments)];
        const edge: string[] = [];
        const back: string[] = [];
        for (let i = first; i < last; i++) {
          edge.push(`${at(i).toFixed(3)} ${(HEIGHT * (1 - above[i])).toFixed(1)}`);
          back.push(`${at(i).toFixed(3)} ${(HEIGHT * (1 - below[i])).toFixed(1)}`);
        }
        const path = document.createElementNS(SVG, "path");
        path.setAttribute("d", `M${edge.join("L")}L${back.reverse().join("L")}Z`);
        path.style.fill = fill;
        const title = document.createElementNS(SVG, "title");
        title.textContent = c.name;
        path.append(title);
        svg.append(path);
      }
      const held = runs(moments, (i) => values[i * n + k] >= 0.5).map(([from, to]): [number, number] => [at(from), at(to - 1)]);
      for (const [start, end] of held) {
        const element = make("span", { class: c.colour === null ? "band-name none" : "band-name" });
        element.style.left = this.share((start + end) / 2);
        if (c.colour !== null) element.style.color = textOn(this.colour(c.colour));
        // A letter more than fits is read all the same: the band's slopes are beside it.
        this.labels.push({ element, start: start - 0.5 / track.rate_hz, end: end + 0.5 / track.rate_hz, texts: [c.name] });
        lane.append(element);
      }
      below.set(above);
    });
    this.rows.push({
      now: (secs) => {
        const i = Math.round((secs - track.start_secs) * track.rate_hz);
        if (i < 0 || i >= moments) return void (now.textContent = "");
        let best = 0;
        for (let k = 1; k < n; k++) if (values[i * n + k] > values[i * n + best]) best = k;
        now.textContent = `${track.classes[best].name} ${Math.round(100 * values[i * n + best])} %`;
      },
    });
  }

  private line(track: Line, lane: HTMLElement, now: HTMLElement): void {
    const values = floats(track.values);
    let [low, high] = [0, 1e-9];
    for (const v of values) [low, high] = [Math.min(low, v), Math.max(high, v)];
    const at = (v: number, i: number): string =>
      `${(track.start_secs + i / track.rate_hz).toFixed(3)} ${(HEIGHT * (0.94 - (0.9 * (v - low)) / (high - low))).toFixed(1)}`;
    const path = document.createElementNS(SVG, "path");
    path.setAttribute("d", `M${Array.from(values, at).join("L")}`);
    path.setAttribute("class", "curve");
    this.svg(lane).append(path);
    const digits = Math.min(Math.max(2 - Math.floor(Math.log10(high)), 0), 4);
    lane.append(make("span", { class: "most", "aria-label": "greatest value" }, `\u2264 ${short(high, digits)}`));
    this.rows.push({
      now: (secs) => {
        const i = Math.round((secs - track.start_secs) * track.rate_hz);
        now.textContent = i >= 0 && i < values.length ? short(values[i], digits) : "";
      },
    });
  }

  private svg(lane: HTMLElement): SVGSVGElement {
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", `0 0 ${this.secs} ${HEIGHT}`);
    svg.setAttribute("preserveAspectRatio", "none");
    lane.append(svg);
    return svg;
  }
}

/** Stretches of moments in which something holds: from, and up to but without. */
function runs(moments: number, holds: (i: number) => boolean): [number, number][] {
  const found: [number, number][] = [];
  for (let i = 0; i < moments; i++) {
    if (!holds(i)) continue;
    const from = i;
    while (i + 1 < moments && holds(i + 1)) i++;
    found.push([from, i + 1]);
  }
  return found;
}

/** What all names begin with, up to their last hyphen. */
function commonPrefix(names: string[]): string {
  const hyphened = names.filter((name) => name.includes("-"));
  if (hyphened.length === 0) return "";
  let prefix = hyphened[0].slice(0, hyphened[0].lastIndexOf("-") + 1);
  while (!hyphened.every((name) => name.startsWith(prefix))) prefix = prefix.slice(0, prefix.slice(0, -1).lastIndexOf("-") + 1);
  return prefix;
}

function told(span: Stretch): string {
  const detail = span.detail ? `\n${span.detail}` : "";
  return `${span.name}, ${short(span.start)} to ${short(span.end)} s${detail}`;
}
