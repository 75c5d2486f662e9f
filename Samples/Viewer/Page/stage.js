// The place that bodies are shown in: renderer, camera, light, sky and ground.
import {
  BackSide, Color, DirectionalLight, Fog, HemisphereLight, Mesh, MeshStandardMaterial, NeutralToneMapping, PCFShadowMap,
  PerspectiveCamera, PlaneGeometry, PMREMGenerator, Scene, ShaderMaterial, SphereGeometry, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import { addGrid } from './shaders.js';

const THEMES = {
  light: { horizon: '#e3e9ee', zenith: '#a9c3dc', ground: '#d3d9de', sky: 1.15, sun: 2.6, room: 0.42 },
  dark: { horizon: '#232a32', zenith: '#0c1015', ground: '#3a424b', sky: 0.95, sun: 1.9, room: 0.3 },
};
const LIGHT_DIRECTION = new Vector3(-0.55, 1, 0.62).normalize();
const FROM = [0.62, 0.42, 1]; // where the camera is, unless the scene says otherwise
const MARGIN = 0.9;           // part of the picture that the subject may fill
const WITHOUT_ENVIRONMENT = 1.75;
const LEAST_PIXELS = 1.3;     // half the size of the smallest body

function makeSky(colors) {
  const material = new ShaderMaterial({
    side: BackSide,
    depthWrite: false,
    uniforms: colors,
    vertexShader: `
      varying vec3 direction;
      void main() {
        direction = position;
        gl_Position = (projectionMatrix * vec4(mat3(modelViewMatrix) * position, 1.0)).xyww;
      }`,
    fragmentShader: `
      uniform vec3 horizon, zenith;
      varying vec3 direction;
      void main() {
        gl_FragColor = vec4(mix(horizon, zenith, smoothstep(0.0, 0.7, normalize(direction).y)), 1.0);
        #include <colorspace_fragment>
      }`,
  });
  const sky = new Mesh(new SphereGeometry(1, 24, 16), material);
  sky.frustumCulled = false;
  sky.renderOrder = -1;
  return sky;
}

function nameOfRenderer(context) {
  const information = context.getExtension('WEBGL_debug_renderer_info');
  return information ? String(context.getParameter(information.UNMASKED_RENDERER_WEBGL)) : '';
}

export class Stage {
  // `subject`: { center: [x, y, z], half, radius, lowest } in meters, what the picture is about; `from` towards the camera.
  // `isFine`: with reflections of an environment, which software takes ten seconds to prepare; undefined: where a GPU draws.
  constructor(canvas, subject, isFine) {
    this.subject = subject;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.isFine = isFine ?? !/swiftshader|llvmpipe|software/i.test(nameOfRenderer(this.renderer.getContext()));
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.toneMappingExposure = 1.12;
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
    this.setTheme('light');
  }

  get theme() { return this.themeName; }
  setTheme(name) {
    this.themeName = name;
    const { horizon, zenith, ground, sky, sun, room } = THEMES[name];
    this.skyColors.horizon.value.set(horizon);
    this.skyColors.zenith.value.set(zenith);
    this.scene.fog.color.set(horizon);
    this.ground?.material.color.set(ground);
    this.skyLight.intensity = this.isFine ? sky : sky * WITHOUT_ENVIRONMENT;
    this.sun.intensity = sun;
    this.scene.environmentIntensity = room;
  }

  // A ground without an end at a height, which fades into the horizon.
  addGround(y) {
    const { center, radius } = this.subject;
    const material = addGrid(new MeshStandardMaterial({ color: THEMES[this.themeName].ground, roughness: 0.95 }), this.grid);
    this.ground = new Mesh(new PlaneGeometry(160 * radius, 160 * radius).rotateX(-Math.PI / 2), material);
    this.ground.position.set(center[0], y, center[2]);
    this.ground.receiveShadow = true;
    this.scene.add(this.ground);
  }

  // The subject's box fills the picture, whatever its proportions.
  frameSubject() {
    const { center, half, from } = this.subject;
    const towards = new Vector3(...(from ?? FROM)).normalize();
    const right = new Vector3(0, 1, 0).cross(towards).normalize(), up = new Vector3().crossVectors(towards, right);
    const corners = [];
    for (const x of [-1, 1]) for (const y of [-1, 1]) for (const z of [-1, 1]) {
      const corner = new Vector3(x * half[0], y * half[1], z * half[2]);
      corners.push([corner.dot(right), corner.dot(up), corner.dot(towards)]);
    }
    const tangent = MARGIN * Math.tan((this.camera.fov * Math.PI) / 360), wide = tangent * this.camera.aspect;
    let shiftX = 0, shiftY = 0, distance = 1;
    for (let i = 0; i < 4; ++i) {
      distance = Math.max(...corners.map(([x, y, z]) => z + Math.max(Math.abs(x - shiftX) / wide, Math.abs(y - shiftY) / tangent)));
      const middle = (k, shift) => {
        const seen = corners.map((corner) => (corner[k] - shift) / (distance - corner[2]));
        return (distance * (Math.min(...seen) + Math.max(...seen))) / 2;
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
    this.least.leastSize.value = (LEAST_PIXELS * 2 * Math.tan((this.camera.fov * Math.PI) / 360)) / this.height;
    this.renderer.render(this.scene, this.camera);
  }

  #addLights() {
    const { center, radius } = this.subject;
    if (this.isFine) {
      const generator = new PMREMGenerator(this.renderer);
      this.scene.environment = generator.fromScene(new RoomEnvironment(), 0.04).texture;
      generator.dispose();
    }
    this.skyLight = new HemisphereLight('#ffffff', '#cfc8be', 1);
    this.scene.add(this.skyLight);
    const sun = (this.sun = new DirectionalLight('#fff1dc', 2));
    sun.target.position.set(...center);
    sun.position.copy(LIGHT_DIRECTION).multiplyScalar(4 * radius).add(sun.target.position);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    const reach = 1.35 * radius;
    Object.assign(sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: radius, far: 8 * radius });
    sun.shadow.normalBias = (2.5 * reach) / 2048;
    sun.shadow.bias = -0.0002;
    sun.shadow.radius = 3;
    this.scene.add(sun, sun.target);
    // From the other side, so that nothing seen from the front is flat gray.
    const fill = new DirectionalLight('#dbe8ff', 0.5);
    fill.position.set(0.9, 0.3, 0.2);
    this.scene.add(fill);
  }
}
