// Sensors, which touch nothing: one sees through them, and their edges.
import { Color, EdgesGeometry, InstancedBufferGeometry, LineSegments, MeshStandardMaterial, ShaderMaterial } from 'three';

export const SENSOR = 3; // beside the motions: static 0, kinematic 1, dynamic 2
const SHARP = 20; // degrees: what bends by less has no edge

export class Glass {
  constructor(stage) {
    this.stage = stage;
    this.material = new MeshStandardMaterial({
      vertexColors: true, roughness: 0.2, transparent: true, opacity: 0.22, depthWrite: false,
    });
    this.lines = new ShaderMaterial({
      uniforms: { tint: { value: new Color('#1f7f99') } },
      vertexShader: `
        attribute mat4 place;
        void main() { gl_Position = projectionMatrix * viewMatrix * place * vec4(position, 1.0); }`,
      fragmentShader: `
        uniform vec3 tint;
        void main() {
          gl_FragColor = vec4(tint, 1.0);
          #include <colorspace_fragment>
        }`,
    });
  }

  // Of an instanced mesh, whose matrices it shares.
  addOutline(mesh) {
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute('position', new EdgesGeometry(mesh.geometry, SHARP).attributes.position);
    geometry.setAttribute('place', mesh.instanceMatrix);
    geometry.instanceCount = mesh.count;
    const outline = new LineSegments(geometry, this.lines);
    outline.frustumCulled = false;
    this.stage.scene.add(outline);
  }
}
