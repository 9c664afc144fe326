import type {Group} from 'three';
import type {GLTF, GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import type {Asset, Curves, Face, Fascia} from './index.js';

export interface Take {
  curves: Curves;
  /** Seconds. */
  time: number;
  weight: number;
  layer: number;
  loop: boolean;
  playing: boolean;
}

export interface FaceOptions {
  loader?: GLTFLoader;
  level?: number | string;
  iterations?: number;
}

/** A head in a scene: add `face.scene` to the scene, and `update` it each frame. */
export class FasciaFace {
  static load(fascia: Fascia, url: string | URL, options?: FaceOptions): Promise<FasciaFace>;
  static parse(fascia: Fascia, bytes: ArrayBuffer, options?: FaceOptions): Promise<FasciaFace>;
  constructor(asset: Asset, gltf: GLTF, options?: FaceOptions);
  readonly asset: Asset;
  readonly gltf: GLTF;
  readonly scene: Group;
  readonly face: Face;
  /** Values by name; returns the names that the rig does not know. */
  setWeights(weights: Record<string, number>): string[];
  play(curves: Curves, options?: {weight?: number; loop?: boolean; layer?: number}): Take;
  stop(take: Take): void;
  update(seconds: number): void;
  pose(): void;
  dispose(): void;
}
