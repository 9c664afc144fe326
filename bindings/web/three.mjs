// A Fascia face in three.js: the meshes of a rig, moved by the runtime. Types: three.d.ts.
import {BufferAttribute, DynamicDrawUsage} from 'three';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';

/** A head in a scene. Make it by `FasciaFace.load` or `.parse`, add `face.scene` to the scene, and `update` it. */
export class FasciaFace {
  /** Loads a rig from a URL. `options`: {loader, level, iterations}. */
  static async load(fascia, url, options = {}) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
    return FasciaFace.parse(fascia, await response.arrayBuffer(), options);
  }

  /** The same from the bytes of a .glb file. */
  static async parse(fascia, bytes, options = {}) {
    const asset = fascia.loadAsset(bytes);
    const gltf = await (options.loader ?? new GLTFLoader()).parseAsync(bytes, '');
    return new FasciaFace(asset, gltf, options);
  }

  constructor(asset, gltf, {level = -1, iterations = 0} = {}) {
    this.asset = asset;
    this.gltf = gltf;
    this.scene = gltf.scene;
    this.face = asset.createFace({level, iterations, space: 'mesh'});
    this.parts = [];
    this.takes = [];
    gltf.scene.traverse((object) => {
      if (!object.isMesh) return;
      const place = gltf.parser.associations.get(object);
      const index = asset.meshes.findIndex(
          (mesh) => mesh.mesh === place?.meshes && mesh.primitive === (place.primitives ?? 0));
      if (index < 0) return;
      const count = asset.meshes[index].vertexCount;
      const geometry = object.geometry.clone();  // two nodes may show one mesh, and two faces one file
      for (const name of ['position', 'normal'])
        geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * count), 3).setUsage(DynamicDrawUsage));
      const hasTangents = geometry.attributes.tangent != null && this.face.tangents(index).length > 0;
      if (hasTangents)
        geometry.setAttribute('tangent', new BufferAttribute(new Float32Array(4 * count), 4).setUsage(DynamicDrawUsage));
      geometry.morphAttributes = {};  // the rig moves the head in their place
      object.geometry = geometry;
      object.frustumCulled = false;
      this.parts.push({index, object, hasTangents});
    });
    this.write();
  }

  /** Values by name, as a capture gives them: {jawOpen: 0.3, ...}. Returns the names that the rig does not know. */
  setWeights(weights) { return this.face.setAll(weights); }

  /**
   * Plays curves (fascia.loadCurves) from now on; those of the rig's own animations are in the rig's bytes. Returns
   * a take: {time, weight, loop, playing}.
   */
  play(curves, {weight = 1, loop = false, layer = 0} = {}) {
    const take = {curves, weight, loop, layer, time: 0, playing: true};
    this.takes.push(take);
    return take;
  }
  stop(take) { this.takes = this.takes.filter((other) => other !== take); }

  /** Lets `seconds` pass and moves the meshes. */
  update(seconds) {
    for (const take of this.takes) {
      this.face.apply(take.curves, take.time, take.weight, take.layer);
      if (!take.playing) continue;
      take.time += seconds;
      if (take.time <= take.curves.duration) continue;
      if (take.loop) take.time %= Math.max(1e-6, take.curves.duration);
      else take.playing = false;
    }
    this.face.step(Math.min(seconds, 0.25));
    this.write();
  }

  /** Goes to the pose of the present values at once. */
  pose() {
    this.face.pose();
    this.write();
  }

  /** @private */
  write() {
    for (const {index, object, hasTangents} of this.parts) {
      const {position, normal, tangent} = object.geometry.attributes;
      position.array.set(this.face.positions(index));
      normal.array.set(this.face.normals(index));
      position.needsUpdate = normal.needsUpdate = true;
      if (!hasTangents) continue;
      tangent.array.set(this.face.tangents(index));
      tangent.needsUpdate = true;
    }
  }

  dispose() {
    for (const {object} of this.parts) object.geometry.dispose();
    this.scene.removeFromParent();
    this.face.dispose();
    this.asset.dispose();
  }
}
