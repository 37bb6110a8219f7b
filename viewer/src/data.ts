// The scene as the page holds it: the types of kineme-report's `scene`, and its packed numbers.

export interface Places {
  rows: number;
  points: number;
  step: number;
  data: string;
}

export interface Bone {
  ends: [number, number];
  radii: [number, number];
}

export interface Body {
  name: string;
  points: number;
  centre: number;
  /** The point that each point hangs on; null for one that goes its own way. */
  parents: (number | null)[];
  bones: Bone[];
  tips: number[];
}

export interface Actor {
  name: string;
  body: number;
  colour: number | null;
  ghost: boolean;
  /** The track whose colour of the moment it wears. */
  wears: number | null;
  rate_hz: number;
  start_secs: number;
  aside: [number, number, number];
  frames: Places;
}

export interface Stretch {
  start: number;
  end: number;
  name: string;
  colour: number | null;
  detail: string;
}

export interface Bands {
  kind: "bands";
  title: string;
  classes: { name: string; colour: number | null }[];
  rate_hz: number;
  start_secs: number;
  shares: string;
}

export interface Spans {
  kind: "spans";
  title: string;
  spans: Stretch[];
}

export interface Line {
  kind: "line";
  title: string;
  rate_hz: number;
  start_secs: number;
  values: string;
}

export type Track = Bands | Spans | Line;

export interface Take {
  name: string;
  note: string;
  secs: number;
  actors: Actor[];
  tracks: Track[];
}

export interface Axis {
  name: string;
  unit: string;
  low: number;
  high: number;
  nodes: number;
  start: number;
}

export interface Flow {
  explained: [number, number, number];
  lattice: string;
  exemplars: string;
}

export interface Card {
  name: string;
  facts: [string, string][];
  doubt: string;
  colour: number;
  body: number;
  cyclic: boolean;
  axes: Axis[];
  phases: number;
  lattice: Places;
  clock: string;
  exemplars: { name: string; secs: number; parameters: number[] }[];
  paths: Places;
  more: number;
  flow: Flow | null;
}

export interface Scene {
  palette: string[];
  bodies: Body[];
  takes: Take[];
  primitives: Card[];
  /** The file of the primitives, where they may be changed; else empty. */
  vocabulary: string;
}

/** The scene that a page holds: JSON, packed. */
export async function unpacked(text: string): Promise<Scene> {
  const packed = bytes(text.trim()).buffer as ArrayBuffer;
  const json = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return (await new Response(json).json()) as Scene;
}

function bytes(text: string): DataView {
  const raw = atob(text);
  const out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
  return new DataView(out.buffer);
}

/** Coordinates row by row, metres; NaN where a point is missing. */
export function places(packed: Places): Float32Array {
  const view = bytes(packed.data);
  const out = new Float32Array(view.byteLength / 2);
  // A row holds the differences to the one before, which wrap round.
  const row = new Int16Array(Math.max(3 * packed.points, 1));
  for (let i = 0; i < out.length; i++) {
    row[i % row.length] += view.getInt16(2 * i, true);
    // Read again: an assignment's own value has not wrapped.
    const whole = row[i % row.length];
    out[i] = whole === -32768 ? NaN : whole * packed.step;
  }
  return out;
}

export function floats(packed: string): Float32Array {
  const view = bytes(packed);
  const out = new Float32Array(view.byteLength / 4);
  for (let i = 0; i < out.length; i++) out[i] = view.getFloat32(4 * i, true);
  return out;
}

export function shares(packed: string): Float32Array {
  const view = bytes(packed);
  const out = new Float32Array(view.byteLength);
  for (let i = 0; i < out.length; i++) out[i] = view.getUint8(i) / 255;
  return out;
}
