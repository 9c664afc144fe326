// A program in TypeScript: every member of the types is used as it is meant, and wrong uses are errors.
import {FasciaError, loadFascia} from '@fascia/runtime';
import type {Asset, Channel, Curves, Face, Fascia, Mesh} from '@fascia/runtime';
import {FasciaFace} from '@fascia/runtime/three';
import type {FaceOptions, Take} from '@fascia/runtime/three';
import {Scene} from 'three';

export async function play(bytes: ArrayBuffer): Promise<number> {
  const fascia: Fascia = await loadFascia({wasm: new Uint8Array(8)});
  const [major]: [number, number, number] = fascia.version;
  const asset: Asset = fascia.loadAsset(bytes);
  const channel: Channel = asset.channels[0];
  const mesh: Mesh = asset.meshes[0];
  const members: string[] = asset.sets.arkit;
  const face: Face = asset.createFace({level: 'low', space: 'metres', iterations: 1});
  face.set(channel.name, channel.maximum);
  face.values[0] = face.effectiveValues[0] + face.get(members[0]) + major;
  const unknown: string[] = face.setAll({jawOpen: 0.3});
  const curves: Curves = fascia.loadCurves('time,jawOpen\n0,0\n', {framesPerSecond: 30});
  face.setLayer(1, {combine: 'saturate', weight: 0.5, mask: null});
  const layer: Float32Array | null = face.layerValues(1);
  face.apply(curves, curves.duration, 1, 1);
  face.lookAt([0, 0, 1]);
  face.lookAt(null);
  face.blend(0, 0.5);
  face.pose();
  const isSound: boolean = face.step(1 / 60);
  face.moveHead(asset.inputToMetres, 1);
  face.setLevel(face.level, 0.25);
  const state: Uint8Array = face.save();
  face.restore(state);
  const numbers = face.positions(0).length + face.normals(0).length + face.compression(0).length + face.tangents(0).length +
      mesh.triangles.length;
  face.clear();
  face.reset();
  face.dispose();
  curves.dispose();
  asset.dispose();
  return numbers + unknown.length + (layer?.length ?? 0) + (isSound ? 1 : 0);
}

export async function show(fascia: Fascia, scene: Scene): Promise<Take> {
  const options: FaceOptions = {level: -1};
  const face: FasciaFace = await FasciaFace.load(fascia, 'rig.glb', options);
  scene.add(face.scene);
  const unknown: string[] = face.setWeights({jawOpen: 0.3});
  const take: Take = face.play(fascia.loadCurves(new Uint8Array()), {loop: true, weight: 1, layer: 0});
  face.update(1 / 60);
  face.pose();
  face.stop(take);
  face.dispose();
  if (unknown.length > 0) throw new FasciaError(unknown.join());
  return take;
}

export function wrong(face: Face): void {
  // @ts-expect-error a number is wanted
  face.set('jawOpen', '1');
  // @ts-expect-error there is no such space
  face.asset.createFace({space: 'inches'});
  // @ts-expect-error the level is read only
  face.level = 1;
}
