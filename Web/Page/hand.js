// The hand: pulls a body by a target joint under the pointer, and shoots balls. Beside a body the camera's controls act.
import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, Plane, Raycaster, Vector2, Vector3 } from 'three';

const REACH = 1e4;           // m
const STRENGTH = 60;         // of the body's weight in gravity 9.81: the largest force along an axis
const SHOT_SPEED = 30;       // of the ball's radius times its own rate, see shoot
const BALLS_RADIUS = 0.75;   // of the radius of a typical body
const APART = 2.1;           // radii from one ball to the next, where they are shot one right after the other
const MOST_IN_LINE = 20;

export class Hand {
  // `place`: around the canvas. `get`: { world, stage, origin, typical } as they are now.
  constructor(place, get) {
    this.place = place;
    this.get = get;
    this.pointer = new Vector2(0, 0);
    this.raycaster = new Raycaster();
    this.plane = new Plane();
    this.line = new Line(new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(6), 3)), new LineBasicMaterial({ color: '#ff4d1c', depthTest: false }));
    this.line.frustumCulled = false;
    this.line.renderOrder = 10;
    place.addEventListener('pointerdown', (event) => this.#down(event), true); // before the camera's controls
    place.addEventListener('pointermove', (event) => this.#move(event));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) place.addEventListener(end, () => this.release());
  }
  get isHolding() { return this.joint !== undefined; }

  // A hit of what the pointer is on, in the world; undefined: nothing, or nothing that can be pulled.
  #grab() {
    const { world, origin } = this.get();
    const { origin: from, direction } = this.raycaster.ray;
    const hit = world.queries.castRay({
      origin: from.toArray().map((x, k) => x + origin[k]), displacement: direction.toArray().map((x) => REACH * x),
    });
    if (!hit) return undefined;
    const body = world.bodies.read(hit.body);
    return body.motion === 'Dynamic' ? { ...hit, mass: body.mass } : undefined;
  }

  #aim(event) {
    const { left, top, width, height } = this.place.getBoundingClientRect();
    this.pointer.set((2 * (event.clientX - left)) / width - 1, 1 - (2 * (event.clientY - top)) / height);
    const { camera } = this.get().stage;
    camera.updateMatrixWorld();
    this.raycaster.setFromCamera(this.pointer, camera);
  }

  #down(event) {
    this.#aim(event);
    if (event.button !== 0) return;
    const hit = this.#grab();
    if (!hit) return;
    const { world, stage, origin } = this.get();
    event.stopPropagation(); // the camera stays
    this.place.setPointerCapture(event.pointerId);
    stage.controls.enabled = false;
    const target = new Vector3(...hit.position.map((x, k) => x - origin[k]));
    this.plane.setFromNormalAndCoplanarPoint(stage.camera.getWorldDirection(new Vector3()), target);
    this.joint = world.joints.createTarget({
      body: hit.body, anchor: hit.position, target: hit.position, spring: { frequency: 4, dampingRatio: 1 }, maxForce: STRENGTH * 9.81 * hit.mass,
    });
    this.world = world;
    stage.scene.add(this.line);
    this.draw();
  }

  #move(event) {
    this.#aim(event);
    if (!this.isHolding) return;
    const { world, origin } = this.get();
    const at = this.raycaster.ray.intersectPlane(this.plane, new Vector3());
    if (at && world === this.world && world.joints.exists(this.joint)) world.joints.setTarget(this.joint, at.toArray().map((x, k) => x + origin[k]));
  }

  release() {
    if (!this.isHolding) return;
    const { world, stage } = this.get();
    if (world === this.world && world.joints.exists(this.joint)) world.joints.remove(this.joint);
    this.joint = this.world = undefined;
    stage.controls.enabled = true;
    this.line.removeFromParent();
  }

  // The line from the hand to the body. The joint ends with its body.
  draw() {
    if (!this.isHolding) return;
    const { world, origin } = this.get();
    if (world !== this.world || !world.joints.exists(this.joint)) return this.release();
    const { anchorA, anchorB } = world.joints.read(this.joint);
    const places = this.line.geometry.attributes.position;
    [anchorA, anchorB].forEach((anchor, i) => places.setXYZ(i, ...anchor.map((x, k) => x - origin[k])));
    places.needsUpdate = true;
  }

  // A heavy ball from the camera to where the pointer is, fast enough to be there within half a second. While the last one is still
  // where it begins, it follows behind that; undefined: there is no room.
  shoot() {
    const { world, stage, origin, typical } = this.get();
    stage.camera.updateMatrixWorld();
    this.raycaster.setFromCamera(this.pointer, stage.camera);
    const { origin: from, direction } = this.raycaster.ray;
    const radius = BALLS_RADIUS * typical, distance = stage.camera.position.distanceTo(stage.controls.target);
    const speed = Math.max(SHOT_SPEED * radius, 2.5 * distance);
    const shape = { kind: 'Sphere', radius };
    const places = Array.from({ length: MOST_IN_LINE }, (_, i) => from.clone()
      .addScaledVector(direction, 0.25 * distance - i * APART * radius).toArray().map((x, k) => x + origin[k]));
    const position = places.find((place) => world.queries.findOverlaps({ shape, position: place }).length === 0);
    return position && world.bodies.create({
      shape, density: 4000, continuous: 'LinearAndAngular', position, linearVelocity: direction.toArray().map((x) => speed * x), maxLinearSpeed: Math.max(1000, 2 * speed),
    });
  }
}
