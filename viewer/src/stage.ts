// The stage: one take at a time, its actors in three dimensions, its tracks beneath.
import * as THREE from "three";
import { places, type Actor, type Scene, type Take } from "./data";
import { button, choice, make, toggle } from "./dom";
import { Figure, FINE } from "./figure";
import { Player } from "./player";
import { around } from "./rows";
import { Timeline } from "./timeline";
import { neutral, View } from "./world";

interface Playing {
  actor: Actor;
  figure: Figure;
  frames: Float32Array;
  colour: THREE.Color;
  shown: boolean;
}

/** Seconds in which a colour comes and goes. */
const FADE = 0.1;

export class Stage {
  readonly player: Player;
  private readonly view = new View("Bodies in motion; drag to turn, scroll to come nearer after a click");
  private readonly timeline: Timeline;
  private readonly legend = make("div", { class: "legend", role: "group", "aria-label": "Bodies" });
  private readonly note = make("p", { class: "note" });
  private readonly beside: HTMLButtonElement;
  private readonly focus = new THREE.Vector3();
  private playing: Playing[] = [];
  private take: Take;
  private following = true;
  private apart = true;

  constructor(private readonly scene: Scene, private readonly section: HTMLElement) {
    this.take = scene.takes[0];
    this.timeline = new Timeline(scene.palette, (secs) => this.player.put(secs));
    this.player = new Player("the motion", () => this.pose());
    this.beside = toggle("Stand side by side", "Side by side", true, (on) => {
      this.apart = on;
      this.pose();
      this.frame();
    });
    const tools = make("div", { class: "tools" },
      this.beside,
      toggle("Follow the body", "Follow", true, (on) => {
        this.following = on;
        this.pose();
      }),
      button("Reset the camera", "Reset", () => this.frame()),
      this.player.speeds,
    );
    const port = make("div", { class: "viewport", tabindex: "0", role: "group", "aria-label": "The stage: space plays, arrows step, A and D turn, W and S come nearer and go farther" },
      this.view.canvas, this.legend, tools);
    port.addEventListener("keydown", (event) => this.turned(event));
    if (scene.takes.length > 1) {
      section.append(choice("Motion", scene.takes.map((take) => take.name), (i) => this.show(scene.takes[i])));
    }
    const transport = make("div", { class: "transport" }, make("div", { class: "gutter" }, this.player.play, this.player.time), this.player.scrub);
    section.append(port, transport, this.timeline.element, this.note);
    this.show(this.take);
  }

  get element(): HTMLElement {
    return this.section;
  }

  tick(secs: number): void {
    if (this.view.visible) this.player.tick(secs);
    this.view.draw();
  }

  private show(take: Take): void {
    this.take = take;
    this.view.content.clear();
    this.legend.replaceChildren();
    this.playing = take.actors.map((actor) => {
      const body = this.scene.bodies[actor.body];
      const figure = new Figure(body, FINE, actor.ghost ? 0.38 : null);
      this.view.content.add(figure.group);
      const playing: Playing = { actor, figure, frames: places(actor.frames), colour: new THREE.Color(), shown: true };
      if (take.actors.length > 1) this.legend.append(this.entry(playing));
      return playing;
    });
    this.beside.hidden = take.actors.every((a) => a.aside.every((c) => c === 0));
    this.note.textContent = take.note;
    this.note.hidden = take.note === "";
    this.timeline.show(take);
    this.player.secs = 0;
    this.player.lasts(take.secs);
    this.player.put(0);
    this.frame();
  }

  private entry(playing: Playing): HTMLElement {
    const box = make("input", { type: "checkbox", checked: "" });
    box.addEventListener("change", () => {
      playing.shown = box.checked;
      this.pose();
    });
    const { colour, ghost, name } = playing.actor;
    const chip = make("i", { class: ghost ? "chip ghost" : "chip" });
    chip.style.background = colour === null ? "var(--none)" : this.scene.palette[colour % this.scene.palette.length];
    // A colour of its own tells a body from the others, and so does being seen through.
    return make("label", {}, box, ...(colour !== null || ghost ? [chip] : []), name);
  }

  /** The colour of an actor at a moment: its own, or that of what it does, which comes and goes in a tenth of a second. */
  private dress({ actor, colour }: Playing, secs: number): THREE.Color {
    colour.set(actor.colour === null ? neutral() : this.scene.palette[actor.colour % this.scene.palette.length]);
    const track = actor.wears === null ? undefined : this.take.tracks[actor.wears];
    if (track?.kind !== "spans") return colour;
    for (const span of track.spans) {
      if (span.colour === null || secs < span.start || secs > span.end) continue;
      const there = Math.min(1, (secs - span.start) / FADE, (span.end - secs) / FADE);
      return colour.lerp(new THREE.Color(this.scene.palette[span.colour % this.scene.palette.length]), 0.85 * there);
    }
    return colour;
  }

  /** Puts every body into its posture of the moment. */
  private pose(): void {
    const secs = this.player.secs;
    this.timeline.now(secs);
    for (const playing of this.playing) {
      const { actor, figure, frames, shown } = playing;
      const at = (secs - actor.start_secs) * actor.rate_hz;
      const here = at > -1 && at < actor.frames.rows;
      figure.group.visible = shown && here;
      if (!figure.group.visible) continue;
      figure.take(frames, around(actor.frames.rows, at));
      figure.group.position.fromArray(this.apart ? actor.aside : [0, 0, 0]);
      figure.colour(this.dress(playing, secs));
    }
    if (this.following) {
      this.middle(this.focus);
      this.focus.z = this.view.controls.target.z;
      if (Number.isFinite(this.focus.x)) this.view.follow(this.focus);
    }
    this.view.touch();
  }

  /** The middle of the bodies' centres. */
  private middle(out: THREE.Vector3): void {
    out.set(0, 0, 0);
    const centre = new THREE.Vector3();
    let count = 0;
    for (const { figure } of this.playing) {
      if (!figure.group.visible || Number.isNaN(figure.centre(centre).x)) continue;
      out.add(centre);
      count += 1;
    }
    out.divideScalar(count);
  }

  /** The camera's usual place: everybody in sight. */
  private frame(): void {
    const at = new THREE.Vector3();
    this.middle(at);
    if (!Number.isFinite(at.x)) at.set(0, 0, 0.9);
    const centre = new THREE.Vector3();
    const wide = this.playing.map(({ figure }) => figure.centre(centre).setZ(0).distanceTo(at.clone().setZ(0)));
    const spread = Math.max(0, ...wide.filter(Number.isFinite));
    this.view.reach = 1.7 + spread;
    at.z = 0.95;
    this.view.look(at, 4.0 + 0.9 * spread);
  }

  private turned(event: KeyboardEvent): void {
    const turns: Record<string, [number, number]> = { a: [-0.12, 1], d: [0.12, 1], w: [0, 0.92], s: [0, 1.08] };
    const turn = turns[event.key.toLowerCase()];
    if (!turn || event.ctrlKey || event.metaKey || event.altKey) return;
    this.view.turn(...turn);
    event.preventDefault();
  }
}
