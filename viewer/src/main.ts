// The page's program: draws the scene that the page holds.
import { CardView } from "./card";
import { unpacked, type Scene } from "./data";
import type { Player } from "./player";
import { Edits } from "./edits";
import { Stage } from "./stage";
import { slow } from "./world";
import "./viewer.css";

interface Part {
  readonly element: HTMLElement;
  readonly player: Player;
  tick(secs: number): void;
}

function start(scene: Scene): void {
  const parts: Part[] = [];
  const section = document.getElementById("stage");
  if (section && scene.takes.length > 0) {
    const stage = new Stage(scene, section);
    parts.push(stage);
    document.addEventListener("click", (event) => {
      const link = (event.target as HTMLElement).closest<HTMLElement>("a[data-take]");
      if (!link || event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      stage.play(Number(link.dataset.take), Number(link.dataset.secs));
    });
  }

  // A card is made when it is about to be seen: a page may hold many.
  const cards = [...document.querySelectorAll<HTMLElement>(".card")];
  const soon = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      soon.unobserve(entry.target);
      const element = entry.target as HTMLElement;
      parts.push(new CardView(scene, scene.primitives[Number(element.dataset.card)], element));
    }
  }, { rootMargin: "300px" });
  for (const card of cards) soon.observe(card);
  if (scene.vocabulary) new Edits(scene, cards);

  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    const own = target.closest("select, textarea, button, a, input:not([type=range])");
    if (own && (event.key === " " || own.matches("select, input, textarea"))) return;
    // A slider of a parameter has the arrows for itself; the one of time has them anyway.
    if (target.matches("input[type=range]:not(.scrub)") && event.key !== " ") return;
    const part = parts.find((p) => p.element.contains(target)) ?? (target === document.body ? parts[0] : undefined);
    if (part?.player.key(event)) event.preventDefault();
  });

  let before = performance.now();
  let rested = 0;
  const frame = (now: number): void => {
    requestAnimationFrame(frame);
    // Where drawing is slow the page must still answer: after a picture it rests as long as the picture took.
    if (now < rested) return;
    // After a pause, such as in a hidden tab, time goes on where it stood.
    const secs = Math.min((now - before) / 1000, 0.25);
    before = now;
    const begun = performance.now();
    for (const part of parts) part.tick(secs);
    const took = performance.now() - begun;
    rested = took > 12 ? begun + took + Math.min(took, 300) : 0;
    if (took > 0.5) slow(took);
  };
  requestAnimationFrame(frame);
}

async function begin(text: string): Promise<void> {
  try {
    start(await unpacked(text));
  } catch (error) {
    const notice = document.createElement("p");
    notice.className = "notice";
    notice.textContent = `The bodies cannot be drawn here: ${error instanceof Error ? error.message : String(error)}. Still figures are below.`;
    document.querySelector("header")?.append(notice);
  }
}

const text = document.getElementById("scene")?.textContent;
if (text) void begin(text);
