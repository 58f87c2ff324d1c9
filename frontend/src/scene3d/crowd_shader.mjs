// Shader of people: linear blend skinning of instances with 28 bones from a texture, with clothes that hang off the body,
// as crowdbot.humans does it.
const DECLARATIONS = /* glsl */ `
uniform highp sampler2D restMap;
uniform highp sampler2D boneMap;
uniform float vertices;
uniform float headless;
attribute float source;
attribute vec4 boneIndex;
attribute vec4 boneWeight;
attribute vec3 regionPartGroup;
attribute vec3 longCut;
attribute vec3 shortCut;
attribute float slot;
#ifdef CROWD_COLOR
uniform sampler2D colorMap;
varying vec3 vCloth;
varying vec4 vTint;
varying float vHead;
#endif
vec3 turnBy(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
`;

/** Bones of the neck and the head, which follow each other. */
const NECK_AND_HEAD = [4, 5];

const SKIN = /* glsl */ `
int row = int(slot + 0.5);
vec4 who = texelFetch(boneMap, ivec2(56, row), 0);
int at = int(who.x * vertices + source + 0.5);
vec3 restPoint = texelFetch(restMap, ivec2(at & 2047, at >> 11), 0).xyz * who.y;
vec4 worn = texelFetch(boneMap, ivec2(58, row), 0);
int cut = int(worn[int(regionPartGroup.z + 0.5)] + 0.5);
restPoint += worn.w * (cut == 1 ? longCut : cut == 2 ? shortCut : vec3(0.0));
vec3 skinned = vec3(0.0);
vec3 bent = vec3(0.0);
for (int k = 0; k < 4; k++) {
  int bone = int(boneIndex[k] + 0.5);
  vec4 q = texelFetch(boneMap, ivec2(2 * bone, row), 0);
  vec3 shift = texelFetch(boneMap, ivec2(2 * bone + 1, row), 0).xyz;
  skinned += boneWeight[k] * (turnBy(q, restPoint) + shift);
  bent += boneWeight[k] * turnBy(q, normal);
}
bool shown = ((int(who.z + 0.5) >> int(regionPartGroup.y + 0.5)) & 1) == 1;
`;

/** Changes a material so that it draws people. `uniforms` are shared by the materials of a level. */
export function drawPeople(material, uniforms, color) {
  material.defines = { ...material.defines, ...(color ? { CROWD_COLOR: 1 } : {}) };
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", `#include <common>\n${DECLARATIONS}`)
      .replace("void main() {", `void main() {\n${SKIN}`)
      .replace("#include <beginnormal_vertex>", "vec3 objectNormal = normalize(bent);")
      .replace(
        "#include <begin_vertex>",
        `vec3 transformed = shown ? skinned : vec3(0.0, 0.0, -1.0e4);
        #ifdef CROWD_COLOR
        vCloth = texelFetch(colorMap, ivec2(int(regionPartGroup.x + 0.5), int(who.w + 0.5)), 0).rgb;
        vTint = texelFetch(boneMap, ivec2(57, row), 0);
        vHead = 0.0;
        if (abs(headless - slot) < 0.5) for (int k = 0; k < 4; k++) {
          if (abs(boneIndex[k] - ${NECK_AND_HEAD[0]}.5) < 0.6) vHead += boneWeight[k];
        }
        #endif`,
      );
    if (color) {
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", "#include <common>\nvarying vec3 vCloth;\nvarying vec4 vTint;\nvarying float vHead;")
        .replace("#include <color_fragment>", "if (vHead > 0.5) discard;\ndiffuseColor.rgb = mix(vCloth, vTint.rgb, vTint.a);");
    }
  };
  material.customProgramCacheKey = () => `crowd${color ? 1 : 0}`;
  return material;
}
