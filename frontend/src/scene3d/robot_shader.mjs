// Shader of robots: each vertex moves with its link, whose pose is in a texture; rows are robots of a kind.
const DECLARATIONS = /* glsl */ `
uniform highp sampler2D poseMap;
attribute float link;
attribute float slot;
vec3 turnBy(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
`;

const POSE = /* glsl */ `
ivec2 place = ivec2(2 * int(link + 0.5), int(slot + 0.5));
vec3 linkPlace = texelFetch(poseMap, place, 0).xyz;
vec4 linkTurn = texelFetch(poseMap, place + ivec2(1, 0), 0);
`;

/** Changes a material so that it draws links at the poses of a texture. */
export function moveLinks(material, poses) {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.poseMap = { value: poses };
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", `#include <common>\n${DECLARATIONS}`)
      .replace("void main() {", `void main() {\n${POSE}`)
      .replace("#include <beginnormal_vertex>", "vec3 objectNormal = turnBy(linkTurn, normal);")
      .replace("#include <begin_vertex>", "vec3 transformed = turnBy(linkTurn, position) + linkPlace;");
  };
  material.customProgramCacheKey = () => "robot";
  return material;
}
