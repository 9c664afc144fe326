/** What went wrong, in the library's own words. */
export class FasciaError extends Error {}

/** Loads the library; `wasm` is a URL, a Response or the bytes, and beside index.mjs when left out. */
export function loadFascia(options?: {wasm?: string | URL | Response | BufferSource}): Promise<Fascia>;

export interface Fascia {
  /** [major, minor, patch] */
  readonly version: [number, number, number];
  /** Loads a rig from the bytes of a .glb file. */
  loadAsset(bytes: BufferSource): Asset;
  /** Loads named values over time from the bytes or the text of a CSV, JSON or glTF file. */
  loadCurves(bytes: BufferSource | string, options?: {framesPerSecond?: number}): Curves;
}

export interface Channel {
  name: string;
  group: string;
  unit: string;
  minimum: number;
  maximum: number;
  rest: number;
}

export interface Mesh {
  /** Indices in the glTF file. */
  mesh: number;
  primitive: number;
  vertexCount: number;
  name: string;
  /** skin, eye_left, teeth_lower, ... */
  part: string;
  triangles: Uint32Array;
}

export interface Asset {
  /** Levels of detail, coarse to fine. */
  readonly levels: {name: string; nodeCount: number}[];
  readonly meshes: Mesh[];
  readonly channels: Channel[];
  /** Members of each vocabulary: {arkit: ["browDownLeft", ...], ...} */
  readonly sets: Record<string, string[]>;
  /** 16 numbers, column-major: from the file's axes and units to metres. */
  readonly inputToMetres: number[];
  /**
   * Makes a face at rest. `level`: index or name, -1 the finest. `space` of positions and normals: the mesh's own
   * ("mesh"), the file's ("input") or metres.
   */
  createFace(options?: {level?: number | string; space?: 'mesh' | 'input' | 'metres'; iterations?: number}): Face;
  dispose(): void;
}

/** One head. Arrays it returns are views of the library's memory: use them before the next call, or copy them. */
export interface Face {
  readonly asset: Asset;
  /** The channels' own values, to read and write. */
  readonly values: Float32Array;
  /** What the last pose or step used. */
  readonly effectiveValues: Float32Array;
  /** Index of the level of detail. */
  readonly level: number;
  /** By the name of a channel or member: "jaw_open", "arkit:jawOpen", "mouthSmile_L". */
  set(name: string, value: number): void;
  get(name: string): number;
  /** Sets several; returns the names that the rig does not know. */
  setAll(values: Record<string, number>): string[];
  clear(): void;
  /** Adds layer 1 .. 7 or changes how it joins those below; `mask` has one weight a channel. */
  setLayer(index: number, options?: {combine?: 'add' | 'max' | 'saturate' | 'override'; weight?: number;
                                     mask?: ArrayLike<number> | null}): void;
  layerValues(layer: number): Float32Array | null;
  /** Adds curves' values at a time to the next pose or step. */
  apply(curves: Curves, seconds: number, weight?: number, layer?: number): void;
  /** Turns the eyes to a point in metres in the head's frame; null for none. */
  lookAt(point: ArrayLike<number> | null, weight?: number): void;
  /** Brings the share of what drives the face to `share` over `seconds`: 0 lets it come to rest. */
  blend(share: number, seconds: number): void;
  /** The pose in which all forces of the present values balance. */
  pose(): void;
  /** Lets time pass; false when the simulation had to be put back to rest. */
  step(seconds: number): boolean;
  reset(): void;
  /** Where the head stands in the world: 16 numbers, column-major, a rigid transform in metres. */
  moveHead(matrix: ArrayLike<number>, inertiaScale?: number): void;
  setLevel(level: number, seconds?: number): void;
  /** 3 numbers a vertex, in the file's vertex order. */
  positions(mesh: number): Float32Array;
  normals(mesh: number): Float32Array;
  compression(mesh: number): Float32Array;
  /**
   * 4 numbers a vertex: the unit tangent for normal maps and the handedness, 1 or -1. Empty where the file gives the
   * mesh neither tangents nor texture coordinates.
   */
  tangents(mesh: number): Float32Array;
  /** All that the next steps depend on; put back, the motion goes on with the same bits. */
  save(): Uint8Array;
  restore(state: Uint8Array): void;
  dispose(): void;
}

export interface Curves {
  readonly names: string[];
  /** Sentences on how the file was taken. */
  readonly notes: string[];
  /** Seconds. */
  readonly duration: number;
  dispose(): void;
}
