// All bodies as instanced meshes, one for each geometry, moving bodies, fixed ones and sensors apart. Those that move, come or go
// come first in each mesh, so that a frame touches and uploads no more than what changes.
import { Color, InstancedBufferAttribute, InstancedMesh, Matrix4, MeshStandardMaterial, Quaternion, Sphere, Vector3 } from 'three';
import { SELECTED, colorOf } from './colors.js';
import { Glass, SENSOR } from './glass.js';
import { BRASS, GLASS } from './looks.js';
import { isAlwaysTheSame } from './presence.js';
import { GeometryChoice, halfBounds, leavesOf } from './shapes.js';
import { OPAQUE } from './occlusion.js';
import { addBelts, addGrid, addOcclusion, growSmall } from './shaders.js';

const RESTING_WITH_SHADOW_AT_MOST = 30000;
const UNTURNED = new Quaternion();

export class Bodies {
  constructor(recording, timeline, stage) {
    this.recording = recording;
    this.timeline = timeline;
    this.selected = -1;
    this.material = growSmall(new MeshStandardMaterial({ vertexColors: true, roughness: 0.58, metalness: 0.02 }), stage.least);
    this.brass = growSmall(new MeshStandardMaterial({ vertexColors: true, roughness: stage.isFine ? 0.28 : 0.45, metalness: stage.isFine ? 0.7 : 0.15, envMapIntensity: 2.5 }), stage.least);
    this.fixedMaterial = addBelts(addGrid(new MeshStandardMaterial({ vertexColors: true, roughness: 0.95 }), stage.grid), stage.clock);
    this.drivenMaterial = new MeshStandardMaterial({ vertexColors: true, roughness: 0.7 });
    for (const material of [this.material, this.brass, this.fixedMaterial, this.drivenMaterial]) addOcclusion(material, stage.occlusion);
    this.pane = new MeshStandardMaterial({ vertexColors: true, roughness: 0.08, transparent: true, opacity: 0.42, depthWrite: false });
    this.glass = new Glass(stage);
    this.meshes = this.#build();
    for (const { mesh, motion } of this.meshes) {
      stage.scene.add(mesh);
      if (motion === SENSOR) this.glass.addOutline(mesh);
    }
    this.#placeAll(true);
  }

  // Fixed bodies let one see through where they would hide what happens between them.
  setSolid(isSolid) {
    for (const material of [this.fixedMaterial, this.drivenMaterial]) {
      material.transparent = !isSolid;
      material.opacity = isSolid ? 1 : 0.16;
      material.depthWrite = isSolid;
      material.needsUpdate = true;
    }
    for (const { mesh, motion, isOpaque, castsShadow } of this.meshes) {
      if (motion >= 2) continue;
      mesh.castShadow = isSolid && castsShadow;
      if (isSolid && isOpaque) mesh.layers.enable(OPAQUE);
      else mesh.layers.disable(OPAQUE);
    }
  }

  update(mode, top) {
    this.#placeAll(false);
    this.#colorAll(mode, top);
  }

  // The body that the ray meets first, or -1. Through a sensor one picks the dynamic body that is seen in or behind it.
  pick(raycaster) {
    const { motions } = this.recording.bodies, { isSensor } = this.recording;
    const solid = this.fixedMaterial.opacity === 1;
    const meshes = this.meshes.filter(({ motion }) => solid || motion >= 2).map((group) => group.mesh);
    const hits = raycaster.intersectObjects(meshes, false).map((hit) => hit.object.userData.leaves[hit.instanceId])
      .filter((leaf) => this.#isShown(leaf)).map((leaf) => leaf.body);
    const seen = hits.find((body) => !isSensor[body]);
    return (motions[seen] === 2 ? seen : hits[0]) ?? -1;
  }

  #isShown({ presence }) {
    const frame = Math.floor(this.timeline.frame);
    return presence.from <= frame && frame < presence.until;
  }

  #build() {
    const { bodies, bodyCount, frameCount, shapes, movers, presences, isSensor, lookOf } = this.recording;
    const isMover = new Uint8Array(bodyCount);
    for (const body of movers) isMover[body] = 1;
    for (let body = 0; body < bodyCount; ++body) if (!isAlwaysTheSame(presences[body], frameCount)) isMover[body] = 1;
    const leavesOfShape = shapes.map((_, index) => leavesOf(shapes, index));
    const leafCount = bodies.shapes.reduce((sum, shape) => sum + leavesOfShape[shape].length, 0);
    const choice = new GeometryChoice(leafCount, shapes);
    const choiceOf = new Map();
    const groups = new Map();
    for (const moving of [1, 0]) {
      for (let body = 0; body < bodyCount; ++body) {
        if (isMover[body] !== moving) continue;
        const motion = isSensor[body] ? SENSOR : bodies.motions[body];
        const isSharp = motion === 0 || motion === SENSOR;
        for (const presence of presences[body]) {
          for (const leaf of leavesOfShape[presence.shape]) {
            const wanted = isSharp ? 'sharp' : 'bevelled';
            const known = choiceOf.get(leaf) ?? {};
            const look = lookOf.get(body);
            const chosen = look?.teeth > 0 ? choice.of(leaf.shape, isSharp, look) : (known[wanted] ??= choice.of(leaf.shape, isSharp));
            choiceOf.set(leaf, known);
            const byKey = groups.get(chosen.key) ?? groups.set(chosen.key, new Map()).get(chosen.key);
            // What shines or is seen through has a material, so a mesh, of its own.
            const special = [BRASS, GLASS].includes(look?.look) && motion !== SENSOR ? look.look : 0, kind = `${motion} ${special}`;
            const group = byKey.get(kind) ?? byKey.set(kind, { motion, special, make: chosen.make, leaves: [], moving: 0 }).get(kind);
            group.leaves.push({ body, presence, shape: leaf.shape, position: leaf.position, rotation: leaf.rotation, scale: chosen.scale });
            group.moving += moving;
          }
        }
      }
    }
    return [...groups.values()].flatMap((byKey) => [...byKey.values()]).map((group) => this.#addMesh(group));
  }

  #addMesh(group) {
    const material = { [BRASS]: this.brass, [GLASS]: this.pane }[group.special] ??
      [this.fixedMaterial, this.drivenMaterial, this.material, this.glass.material][group.motion];
    const isOpaque = group.motion !== SENSOR && group.special !== GLASS;
    const mesh = new InstancedMesh(group.make(), material, group.leaves.length);
    if (group.motion === 2 || group.special === BRASS) mesh.geometry.setAttribute('halfSize', this.#halfSizes(group.leaves));
    if (group.motion === 0) {
      this.#setBelts(mesh.geometry, group.leaves);
      const slope = new Float32Array(group.leaves.map(({ shape }) => Number(shape.kind === 'box' || shape.triangles?.length <= 4)));
      mesh.geometry.setAttribute('gridSlope', new InstancedBufferAttribute(slope, 1));
    }
    // Of very many bodies at rest, the shadows would cost as much as the bodies.
    group.castsShadow = isOpaque && (group.moving > 0 || group.leaves.length < RESTING_WITH_SHADOW_AT_MOST);
    mesh.castShadow = group.castsShadow;
    mesh.receiveShadow = group.motion !== SENSOR;
    group.isOpaque = isOpaque;
    if (isOpaque) mesh.layers.enable(OPAQUE);
    mesh.frustumCulled = false;
    mesh.boundingSphere = new Sphere(new Vector3(), Infinity); // picking asks each instance
    mesh.setColorAt(0, new Color());
    mesh.userData.leaves = group.leaves;
    return { ...group, mesh };
  }

  // Half the extents of each leaf along its own axes, so that a shader can widen what would be less than a pixel.
  #halfSizes(leaves) {
    const sizes = new InstancedBufferAttribute(new Float32Array(3 * leaves.length), 3), half = new Vector3();
    leaves.forEach(({ shape }, i) => {
      if (shape.kind === 'hull') {
        half.setScalar(0);
        for (const [x, y, z] of shape.vertices) half.max(new Vector3(Math.abs(x), Math.abs(y), Math.abs(z)));
      } else halfBounds(shape, UNTURNED, half);
      half.toArray(sizes.array, 3 * i);
    });
    return sizes;
  }

  #setBelts(geometry, leaves) {
    const velocity = new InstancedBufferAttribute(new Float32Array(3 * leaves.length), 3);
    const turning = new InstancedBufferAttribute(new Float32Array(3 * leaves.length), 3);
    leaves.forEach(({ body }, i) => {
      const look = this.recording.lookOf.get(body);
      if (!look?.velocity) return;
      velocity.array.set(look.velocity, 3 * i);
      turning.array.set([look.pivot[0], look.pivot[2], look.turning[1]], 3 * i);
    });
    geometry.setAttribute('beltVelocity', velocity).setAttribute('beltTurning', turning);
  }

  #placeAll(andResting) {
    const { positions, rotations } = this.timeline;
    const matrix = new Matrix4(), place = new Vector3(), turn = new Quaternion(), size = new Vector3(), offset = new Vector3();
    for (const { mesh, leaves, moving } of this.meshes) {
      const count = andResting ? leaves.length : moving;
      for (let i = 0; i < count; ++i) {
        const { body, position, rotation, scale } = leaves[i];
        if (!this.#isShown(leaves[i])) {
          mesh.instanceMatrix.array.fill(0, 16 * i, 16 * i + 16); // no size at all
          continue;
        }
        turn.fromArray(rotations, 4 * body).normalize();
        place.fromArray(positions, 3 * body).add(offset.copy(position).applyQuaternion(turn));
        matrix.compose(place, turn.multiply(rotation), size.fromArray(scale)).toArray(mesh.instanceMatrix.array, 16 * i);
      }
      if (count > 0) this.#upload(mesh.instanceMatrix, 16 * count);
    }
  }

  // Resting bodies need a color only when the mode or the selection changes.
  #colorAll(mode, top) {
    const color = new Color();
    const state = `${mode} ${this.selected} ${this.theme}`;
    const andResting = state !== this.coloredFor;
    this.coloredFor = state;
    for (const { mesh, leaves, moving } of this.meshes) {
      const count = andResting ? leaves.length : moving;
      for (let i = 0; i < count; ++i) {
        const { body } = leaves[i];
        if (body === this.selected) color.copy(SELECTED);
        else colorOf(mode, this.timeline, body, top, color);
        color.toArray(mesh.instanceColor.array, 3 * i);
      }
      if (count > 0) this.#upload(mesh.instanceColor, 3 * count);
    }
  }

  #upload(attribute, count) {
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(0, count);
    attribute.needsUpdate = true;
  }
}
