// The place that bodies are shown in: renderer, camera, light, sky and ground.
import {
  Color, DirectionalLight, Fog, HemisphereLight, Mesh, MeshStandardMaterial, NeutralToneMapping, PCFShadowMap, PerspectiveCamera,
  PlaneGeometry, Scene, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GROUND } from './colors.js';
import { OPAQUE, Occlusion } from './occlusion.js';
import { ScaleBar } from './scaleBar.js';
import { addGrid, addOcclusion } from './shaders.js';
import { makeEnvironment, makeSky } from './sky.js';
import { cornersOf } from './subject.js';

// `sun`, `fill`: of the two lamps; `ambient`: of the light from all sides, from an environment or without one.
const THEMES = {
  light: { horizon: '#e9ebeb', zenith: '#a3bfdb', ground: GROUND.light, sun: 3.1, fill: 0.35, ambient: [0.5, 1.3] },
  dark: { horizon: '#20262e', zenith: '#0a0e14', ground: GROUND.dark, sun: 2.9, fill: 0.6, ambient: [2.6, 1.3] },
};
const LIGHT_DIRECTION = new Vector3(-0.55, 1, 0.62).normalize();
const FROM = [0.62, 0.42, 1]; // where the camera is, unless the scene says otherwise
const MARGIN = 0.9;           // part of the picture that the subject may fill
const LABELLED = 0.78;        // of its height, where labels stand above bodies
const LEAST_PIXELS = 1.3;     // half the size of the smallest body

function nameOfRenderer(context) {
  const information = context.getExtension('WEBGL_debug_renderer_info');
  return information ? String(context.getParameter(information.UNMASKED_RENDERER_WEBGL)) : '';
}

export class Stage {
  // `subject`: what findSubject returns; without `places` its box is to be in the picture.
  // `isFine`: lit by an environment, which software takes ten seconds to prepare; `isOccluded`: with ambient occlusion, which software
  // takes a second a picture for. Undefined: where a GPU draws.
  constructor(canvas, subject, isFine, isOccluded) {
    this.subject = subject;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    const isSoftware = /swiftshader|llvmpipe|software/i.test(nameOfRenderer(this.renderer.getContext()));
    this.isFine = isFine ?? !isSoftware;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.toneMappingExposure = 1;
    this.scene = new Scene();
    this.scene.fog = new Fog('#ffffff', 1, 1000);
    this.skyColors = { horizon: { value: new Color() }, zenith: { value: new Color() } };
    this.scene.add(makeSky(this.skyColors));
    this.#addLights();
    this.camera = new PerspectiveCamera(36, 1, 0.1, 1000);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    const cell = 10 ** Math.max(-1, Math.round(Math.log10(subject.radius / 18)));
    this.grid = { gridCell: { value: cell }, gridStrength: { value: 1 } };
    this.least = { leastSize: { value: 0 } };
    this.clock = { seconds: { value: 0 } };
    this.height = 1;
    this.scaleBar = new ScaleBar(canvas.parentElement);
    if (isOccluded ?? !isSoftware) this.occlusion = new Occlusion(this.scene, this.camera, this.least);
    this.setTheme('light');
  }

  get theme() { return this.themeName; }
  setTheme(name) {
    this.themeName = name;
    const { horizon, zenith, ground, sun, fill, ambient } = THEMES[name];
    this.skyColors.horizon.value.set(horizon);
    this.skyColors.zenith.value.set(zenith);
    this.scene.fog.color.set(horizon);
    this.ground?.material.color.set(ground);
    this.sun.intensity = sun;
    this.fill.intensity = fill;
    this.isEnvironmentOld = this.isFine;
    if (this.isFine) this.scene.environmentIntensity = ambient[0];
    else this.skyLight.intensity = ambient[1];
  }

  #renewEnvironment() {
    this.isEnvironmentOld = false;
    this.environment?.dispose();
    this.environment = makeEnvironment(this.renderer, { ...this.skyColors, ground: THEMES[this.themeName].ground }, LIGHT_DIRECTION);
    this.scene.environment = this.environment.texture;
  }

  // A ground without an end at a height, which fades into the horizon.
  addGround(y) {
    const { center, radius } = this.subject;
    const material = addGrid(new MeshStandardMaterial({ color: THEMES[this.themeName].ground, roughness: 0.95 }), this.grid);
    addOcclusion(material, this.occlusion);
    this.ground = new Mesh(new PlaneGeometry(160 * radius, 160 * radius).rotateX(-Math.PI / 2), material);
    this.ground.position.set(center[0], y, center[2]);
    this.ground.receiveShadow = true;
    this.ground.layers.enable(OPAQUE);
    this.scene.add(this.ground);
  }

  // What a subject shows fills the picture, whatever its proportions.
  frameSubject(subject = this.subject) {
    const { center, half, from } = subject;
    const places = subject.places ?? cornersOf(center.map((middle, k) => [middle - half[k], middle + half[k]]));
    const towards = new Vector3(...(from ?? FROM)).normalize();
    const right = new Vector3(0, 1, 0).cross(towards).normalize(), up = new Vector3().crossVectors(towards, right);
    const seen = places.map(([x, y, z, radius]) => {
      const place = new Vector3(x - center[0], y - center[1], z - center[2]);
      return [place.dot(right), place.dot(up), place.dot(towards), radius];
    });
    const whole = Math.tan((this.camera.fov * Math.PI) / 360);
    const tangent = (subject.isLabelled ? LABELLED : MARGIN) * whole, wide = MARGIN * whole * this.camera.aspect;
    let shiftX = 0, shiftY = 0, distance = 1;
    for (let i = 0; i < 4; ++i) {
      distance = 0;
      for (const [x, y, z, radius] of seen) {
        distance = Math.max(distance, z + Math.max((Math.abs(x - shiftX) + radius) / wide, (Math.abs(y - shiftY) + radius) / tangent));
      }
      // Half of what is left on one side more than on the other.
      const middle = (k, shift) => {
        let low = Infinity, high = -Infinity;
        for (const place of seen) {
          const near = distance - place[2];
          low = Math.min(low, (place[k] - shift - place[3]) / near);
          high = Math.max(high, (place[k] - shift + place[3]) / near);
        }
        return (distance * (low + high)) / 2;
      };
      shiftX += middle(0, shiftX);
      shiftY += middle(1, shiftY);
    }
    this.controls.target.set(...center).addScaledVector(right, shiftX).addScaledVector(up, shiftY);
    this.camera.position.copy(towards).multiplyScalar(distance).add(this.controls.target);
    this.controls.update();
  }

  project(x, y, z) {
    this.camera.updateMatrixWorld();
    return new Vector3(x, y, z).project(this.camera).toArray();
  }

  // Moves the camera with what it follows.
  moveBy(offset) {
    this.camera.position.add(offset);
    this.controls.target.add(offset);
    this.controls.update();
  }

  resize() {
    const { clientWidth, clientHeight } = this.renderer.domElement.parentElement;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.occlusion?.setSize(clientWidth, clientHeight, this.renderer.getPixelRatio());
    this.height = Math.max(1, clientHeight);
    this.camera.aspect = clientWidth / this.height;
    this.camera.updateProjectionMatrix();
  }

  render() {
    const { radius } = this.subject;
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(distance, 0.2 * radius) / 200;
    this.camera.far = distance + 90 * radius;
    this.camera.updateProjectionMatrix();
    this.scene.fog.near = distance + 2 * radius;
    this.scene.fog.far = distance + 18 * radius;
    const perPixel = (2 * Math.tan((this.camera.fov * Math.PI) / 360)) / this.height; // of the distance
    this.least.leastSize.value = LEAST_PIXELS * perPixel;
    this.scaleBar.update(distance * perPixel);
    if (this.isEnvironmentOld) this.#renewEnvironment();
    this.occlusion?.update(this.renderer, this.subject.typical, distance);
    this.renderer.render(this.scene, this.camera);
  }

  #addLights() {
    const { center, radius } = this.subject;
    this.skyLight = new HemisphereLight('#e6eef8', '#bdb9b2', 0); // where there is no environment
    this.scene.add(this.skyLight);
    const sun = (this.sun = new DirectionalLight('#fff5e8', 2));
    sun.target.position.set(...center);
    sun.position.copy(LIGHT_DIRECTION).multiplyScalar(4 * radius).add(sun.target.position);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    const reach = 1.35 * radius;
    Object.assign(sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: radius, far: 8 * radius });
    sun.shadow.normalBias = (2.5 * reach) / 2048;
    sun.shadow.bias = -0.0006;
    sun.shadow.radius = 3;
    this.scene.add(sun, sun.target);
    // From the other side, so that nothing seen from the front is flat gray.
    this.fill = new DirectionalLight('#dbe8ff', 1);
    this.fill.position.set(0.9, 0.3, 0.2);
    this.scene.add(this.fill);
  }
}
