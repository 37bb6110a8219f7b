// Time that passes, stands, or is put where the reader wants it.
import { button, make, short } from "./dom";
import { still } from "./world";

const SPEEDS = [0.1, 0.25, 0.5, 1, 1.5, 2];

export class Player {
  readonly scrub = make("input", { type: "range", min: "0", step: "any", class: "scrub" });
  readonly time = make("output", { class: "time" });
  readonly speeds = make("select", { "aria-label": "Speed" });
  readonly play: HTMLButtonElement;
  secs = 0;
  private length = 0;
  private playing = false;
  private held = false;

  constructor(what: string, private readonly moved: () => void) {
    this.scrub.setAttribute("aria-label", `Time in ${what}`);
    this.play = button("Play", "", () => this.run(!this.playing));
    this.play.classList.add("play");
    for (const speed of SPEEDS) {
      this.speeds.append(make("option", { value: String(speed) }, `${speed}\u00d7`));
    }
    this.speeds.value = "1";
    this.scrub.addEventListener("input", () => this.put(Number(this.scrub.value)));
    this.scrub.addEventListener("pointerdown", () => (this.held = true));
    addEventListener("pointerup", () => (this.held = false));
    this.run(!still.matches);
  }

  get isPlaying(): boolean {
    return this.playing;
  }

  run(on: boolean): void {
    this.playing = on;
    const label = on ? "Pause" : "Play";
    this.play.textContent = on ? "\u2759\u2759" : "\u25b6\ufe0e";
    this.play.setAttribute("aria-label", label);
    this.play.title = `${label} (space)`;
  }

  /** How long it lasts; the share of it that has passed stays. */
  lasts(secs: number): void {
    const share = this.length > 0 ? this.secs / this.length : 0;
    this.length = Math.max(secs, 1e-3);
    this.scrub.max = String(this.length);
    this.put(share * this.length);
  }

  put(secs: number): void {
    this.secs = Math.min(Math.max(secs, 0), this.length);
    this.scrub.value = String(this.secs);
    const text = `${short(this.secs)} / ${short(this.length)} s`;
    this.scrub.setAttribute("aria-valuetext", text);
    this.time.textContent = text;
    this.moved();
  }

  /** Time passes; at the end it begins anew. */
  tick(secs: number): void {
    if (!this.playing || this.held) return;
    const next = this.secs + secs * Number(this.speeds.value);
    this.put(next > this.length ? next % this.length : next);
  }

  /** Keys: space, arrows, home, end, plus and minus. Whether the key meant something. */
  key(event: KeyboardEvent): boolean {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    const step = event.shiftKey ? 1 : 1 / 30;
    const stepped = (secs: number): void => {
      this.run(false);
      this.put(secs);
    };
    switch (event.key) {
      case " ": this.run(!this.playing); return true;
      case "ArrowLeft": stepped(this.secs - step); return true;
      case "ArrowRight": stepped(this.secs + step); return true;
      case "Home": this.put(0); return true;
      case "End": stepped(this.length); return true;
      case "+": case "=": this.faster(1); return true;
      case "-": this.faster(-1); return true;
      default: return false;
    }
  }

  private faster(by: number): void {
    const at = SPEEDS.indexOf(Number(this.speeds.value)) + by;
    this.speeds.value = String(SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)]);
  }
}
