// Ambient occlusion: how much of the sky the places in the picture see, by three's GTAO (Jimenez et al. 2016) from the depth of what
// is opaque. Materials take it from the light that comes from all sides alone, so that the sun's shadows, labels and lines stay as
// they are.
import { DepthTexture, FloatType, MeshBasicMaterial, NearestFilter, Vector2, WebGLRenderTarget } from 'three';
import { GTAOPass } from 'three/addons/postprocessing/GTAOPass.js';
import { growSmall } from './shaders.js';

export const OPAQUE = 1;         // the layer of what hides the sky
const FAR = 0.02;                // radius of what may hide it, at least this part of the distance to what is looked at
const AO = { samples: 16, scale: 1.6, distanceExponent: 1.5, distanceFallOff: 1 };
const DENOISE = { radius: 5, samples: 16, rings: 2, lumaPhi: 10, depthPhi: 2, normalPhi: 3 };

export class Occlusion {
  // `least`: as growSmall's, so that what is widened hides what it covers.
  constructor(scene, camera, least) {
    this.scene = scene;
    this.camera = camera;
    this.depth = new WebGLRenderTarget(1, 1, { minFilter: NearestFilter, magFilter: NearestFilter, depthTexture: new DepthTexture(1, 1, FloatType) });
    this.material = growSmall(new MeshBasicMaterial({ colorWrite: false }), least);
    this.pass = new GTAOPass(scene, camera, 1, 1, { depthTexture: this.depth.depthTexture }, AO, DENOISE);
    this.pass.output = GTAOPass.OUTPUT.Off; // materials apply it
    this.uniforms = { occlusionMap: { value: this.pass.gtaoMap }, occlusionPixel: { value: new Vector2(1, 1) } };
  }

  // `width`, `height`: of the picture in pixels of the page; of the canvas it has `ratio` times as many.
  setSize(width, height, ratio) {
    this.depth.setSize(width, height);
    this.pass.setSize(width, height);
    this.uniforms.occlusionPixel.value.set(1 / (ratio * width), 1 / (ratio * height));
  }

  // `typical`: the radius of a body of middle size, `distance`: of what is looked at, meters.
  update(renderer, typical, distance) {
    const radius = Math.max(1.5 * typical, FAR * distance);
    this.pass.updateGtaoMaterial({ radius, thickness: radius });
    const { mask } = this.camera.layers;
    this.camera.layers.set(OPAQUE);
    this.scene.overrideMaterial = this.material;
    renderer.shadowMap.autoUpdate = false;
    renderer.setRenderTarget(this.depth);
    renderer.clear();
    renderer.render(this.scene, this.camera);
    renderer.shadowMap.autoUpdate = true;
    this.scene.overrideMaterial = null;
    this.camera.layers.mask = mask;
    this.pass.render(renderer, null, null);
    renderer.setRenderTarget(null);
  }
}
