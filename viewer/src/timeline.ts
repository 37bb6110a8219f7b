// The tracks of a take over its time, with a playhead that can be dragged.
import { floats, shares, type Bands, type Line, type Spans, type Stretch, type Take } from "./data";
import { make, short, textOn } from "./dom";

const SVG = "http://www.w3.org/2000/svg";
const HEIGHT = 100;

interface Row {
  /** Says what there is at a moment. */
  now(secs: number): void;
}

export class Timeline {
  readonly element = make("div", { class: "timeline" });
  private readonly head = make("div", { class: "playhead" });
  private readonly rows: Row[] = [];
  private secs = 1;
  private take: Take | null = null;
  private coloured: string | null = null;

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
    this.take = take;
    this.secs = Math.max(take.secs, 1e-3);
    this.rows.length = 0;
    this.element.replaceChildren();
    for (const track of take.tracks) {
      const title = make("span", { class: "track-title" }, track.title);
      const now = make("span", { class: "track-now" });
      const lane = make("div", { class: "lane" });
      this.element.append(make("div", { class: `track ${track.kind}` }, make("div", { class: "track-head" }, title, now), lane));
      if (track.kind === "spans") this.spans(track, lane, now);
      else if (track.kind === "bands") this.bands(track, lane, now);
      else this.line(track, lane, now);
    }
    if (take.tracks.length > 0) this.element.append(this.head);
  }

  /** The colour of the span of the first such track at the moment, if it has one. */
  colourNow(): string | null {
    return this.coloured;
  }

  now(secs: number): void {
    const spans = this.take?.tracks.find((track) => track.kind === "spans")?.spans ?? [];
    const span = spans.find((s) => s.colour !== null && s.start <= secs && secs < s.end);
    this.coloured = span ? this.colour(span.colour) : null;
    this.head.style.left = `${(100 * secs) / this.secs}%`;
    for (const row of this.rows) row.now(secs);
  }

  private dragged(event: PointerEvent): void {
    const { left, width } = this.element.getBoundingClientRect();
    this.put(((event.clientX - left) / width) * this.secs);
  }

  private colour(group: number | null): string {
    return group === null ? "var(--none)" : this.palette[group % this.palette.length];
  }

  private spans(track: Spans, lane: HTMLElement, now: HTMLElement): void {
    const sorted = [...track.spans].sort((a, b) => a.start - b.start || a.end - b.end);
    // What overlaps goes one line lower.
    const ends: number[] = [];
    const parts = sorted.map((span) => {
      let line = ends.findIndex((end) => end <= span.start + 1e-6);
      if (line < 0) line = ends.push(0) - 1;
      ends[line] = span.end;
      const part = make("div", { class: "span", title: told(span) });
      part.style.left = `${(100 * span.start) / this.secs}%`;
      part.style.width = `${(100 * (span.end - span.start)) / this.secs}%`;
      part.style.setProperty("--line", String(line));
      part.style.background = this.colour(span.colour);
      if (span.colour !== null) part.style.color = textOn(this.colour(span.colour));
      else part.classList.add("none");
      return part;
    });
    lane.style.setProperty("--lines", String(Math.max(ends.length, 1)));
    lane.append(...parts);
    // A name where there is room for it, else what tells it from the others, else nothing.
    const prefix = commonPrefix(sorted.map((span) => span.name));
    const fit = (): void => sorted.forEach((span, i) => {
      const room = (lane.clientWidth * (span.end - span.start)) / this.secs - 6;
      const short = span.name.startsWith(prefix) ? span.name.slice(prefix.length) : span.name;
      parts[i].textContent = [span.name, short].find((name) => 6.3 * name.length <= room) ?? "";
    });
    new ResizeObserver(fit).observe(lane);
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
    const x = (i: number): string => (track.start_secs + i / track.rate_hz).toFixed(3);
    const below = new Float32Array(moments);
    track.classes.forEach((c, k) => {
      const edge: string[] = [];
      const back: string[] = [];
      let most = 0;
      for (let i = 0; i < moments; i++) {
        const share = values[i * n + k];
        most = Math.max(most, share);
        back.push(`${x(i)} ${(HEIGHT * (1 - below[i])).toFixed(1)}`);
        below[i] += share;
        edge.push(`${x(i)} ${(HEIGHT * (1 - below[i])).toFixed(1)}`);
      }
      if (most < 0.01) return;
      const path = document.createElementNS(SVG, "path");
      path.setAttribute("d", `M${edge.join("L")}L${back.reverse().join("L")}Z`);
      path.style.fill = this.colour(c.colour);
      const title = document.createElementNS(SVG, "title");
      title.textContent = c.name;
      path.append(title);
      svg.append(path);
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
      `${(track.start_secs + i / track.rate_hz).toFixed(3)} ${(HEIGHT * (1 - (v - low) / (high - low))).toFixed(1)}`;
    const path = document.createElementNS(SVG, "path");
    path.setAttribute("d", `M${Array.from(values, at).join("L")}`);
    path.setAttribute("class", "curve");
    this.svg(lane).append(path);
    this.rows.push({
      now: (secs) => {
        const i = Math.round((secs - track.start_secs) * track.rate_hz);
        now.textContent = i >= 0 && i < values.length ? short(values[i], 3) : "";
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
