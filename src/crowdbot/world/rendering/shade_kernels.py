"""Kernels of the rasteriser: textures, light, shadows and sky of every pixel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel, prange
from crowdbot.typing import Bytes, Floats, Ints

from .shadow_kernels import BLOCK

Labels = NDArray[np.int32]
Color = tuple[float, float, float]


@kernel(inline=True)
def _along(rows: Floats, x: float, y: float) -> Color:
    """Return ``x * rows[1] + y * rows[2] + rows[3]``."""
    return (
        rows[1, 0] * x + rows[2, 0] * y + rows[3, 0],
        rows[1, 1] * x + rows[2, 1] * y + rows[3, 1],
        rows[1, 2] * x + rows[2, 2] * y + rows[3, 2],
    )


@kernel(inline=True)
def _between(a: Color, row: Floats, share: float) -> Color:
    """Return the colour between ``a`` (share 0) and a row of numbers (share 1)."""
    return a[0] + share * (row[0] - a[0]), a[1] + share * (row[1] - a[1]), a[2] + share * (row[2] - a[2])


@kernel(inline=True)
def _weighted(i: int, j: int, k: int, b0: float, b1: float, b2: float, values: Floats) -> Color:
    """Return the weighted sum of three rows."""
    return (
        b0 * values[i, 0] + b1 * values[j, 0] + b2 * values[k, 0],
        b0 * values[i, 1] + b1 * values[j, 1] + b2 * values[k, 1],
        b0 * values[i, 2] + b1 * values[j, 2] + b2 * values[k, 2],
    )


@kernel(inline=True)
def _bilinear(texels: Bytes, first: int, wide: int, high: int, u: float, v: float) -> Color:
    """Return the colour (0 to 255) at ``u``, ``v`` in one image of a texture that repeats."""
    x, y = u * wide - 0.5, v * high - 0.5
    i, j = int(np.floor(x)), int(np.floor(y))
    fx, fy = x - i, y - j
    i0, j0 = i & (wide - 1), j & (high - 1)  # sides are powers of two
    i1, j1 = (i0 + 1) & (wide - 1), (j0 + 1) & (high - 1)
    a, b = first + 3 * (j0 * wide + i0), first + 3 * (j0 * wide + i1)
    c, d = first + 3 * (j1 * wide + i0), first + 3 * (j1 * wide + i1)
    wa, wb, wc, wd = (1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy
    return (
        wa * texels[a] + wb * texels[b] + wc * texels[c] + wd * texels[d],
        wa * texels[a + 1] + wb * texels[b + 1] + wc * texels[c + 1] + wd * texels[d + 1],
        wa * texels[a + 2] + wb * texels[b + 2] + wc * texels[c + 2] + wd * texels[d + 2],
    )


@kernel
def _texture(texels: Bytes, table: Ints, which: int, u: float, v: float, spread: float) -> Color:
    """Return the colour (0 to 1, linear) of a texture where a pixel covers ``spread`` (squared) of its width."""
    first, wide, high, levels = table[which, 0], table[which, 1], table[which, 2], table[which, 3]
    size = spread * wide * high
    level = 0
    while size > 4.0 and level < levels - 1:
        first += 3 * wide * high
        wide, high = max(1, wide >> 1), max(1, high >> 1)
        size *= 0.25
        level += 1
    r, g, b = _bilinear(texels, first, wide, high, u, v)
    if size > 1.0 and level < levels - 1:
        share = min(np.sqrt(size) - 1.0, 1.0)
        r2, g2, b2 = _bilinear(texels, first + 3 * wide * high, max(1, wide >> 1), max(1, high >> 1), u, v)
        r, g, b = r + share * (r2 - r), g + share * (g2 - g), b + share * (b2 - b)
    scale = 1.0 / 65025.0
    return r * r * scale, g * g * scale, b * b * scale


@kernel(inline=True)
def _lit(
    px: float, py: float, pz: float, shadow: NDArray[np.float32], limits: NDArray[np.float32], axes: Floats, soft: int
) -> float:  # fmt: skip
    """Return the share of the sun, 0 to 1, that reaches a point; ``axes`` are those of the shadow map."""
    x, y, z = px - axes[0, 0], py - axes[0, 1], pz - axes[0, 2]
    u = axes[1, 0] * x + axes[1, 1] * y + axes[1, 2] * z
    v = axes[2, 0] * x + axes[2, 1] * y + axes[2, 2] * z
    deep = axes[3, 0] * x + axes[3, 1] * y + axes[3, 2] * z
    size = shadow.shape[0]
    if u < soft + 1.0 or v < soft + 1.0 or u > size - soft - 2.0 or v > size - soft - 2.0:
        return 1.0
    i, j = int(u), int(v)
    if limits[j // BLOCK, i // BLOCK, 0] >= deep:
        return 1.0  # nothing around is nearer to the light
    if limits[j // BLOCK, i // BLOCK, 1] < deep:
        return 0.0
    fu, fv = u - i, v - j
    total, weight = 0.0, 0.0
    step = max(1, soft // 2)
    for b in range(-soft, soft + 1, step):
        wb = 1.0 - fv if b == -soft else fv if b == soft else 1.0
        for a in range(-soft, soft + 1, step):
            w = (1.0 - fu if a == -soft else fu if a == soft else 1.0) * wb
            weight += w
            if shadow[j + b, i + a] >= deep:
                total += w
    return total / weight


@kernel(inline=True)
def _sky(dx: float, dy: float, dz: float, sky: Floats, texels: Bytes, table: Ints) -> Color:
    """Return the colour (linear) of the sky in a direction of length 1; ``sky`` rows: horizon, zenith, sun, clouds."""
    up = max(dz, 0.0)
    share = up * (1.0 + 0.25) / (up + 0.25)
    r, g, b = _between((sky[0, 0], sky[0, 1], sky[0, 2]), sky[1], share)
    glow = max(0.0, -(dx * sky[4, 0] + dy * sky[4, 1] + dz * sky[4, 2]))
    glow = glow * glow
    glow = glow * glow * glow * glow
    glow = glow * glow * glow * glow
    r, g, b = r + glow * sky[2, 0], g + glow * sky[2, 1], b + glow * sky[2, 2]
    if sky[3, 0] > 0.0 and dz > 0.02:
        u, v = 0.10 * dx / dz + 0.37, 0.10 * dy / dz + 0.11
        cloud, _, _ = _texture(texels, table, 0, u, v, 2e-8 / (dz * dz * dz * dz))
        cover = min(1.0, max(0.0, (cloud - sky[3, 1]) * sky[3, 2])) * sky[3, 0] * min(1.0, dz * 5.0)
        light = 0.75 + 0.25 * cloud
        r += cover * (light * sky[5, 0] - r)
        g += cover * (light * sky[5, 1] - g)
        b += cover * (light * sky[5, 2] - b)
    return r, g, b


@kernel(inline=True)
def _light(
    px: float, py: float, pz: float, nx: float, ny: float, nz: float, vx: float, vy: float, vz: float,
    gloss: float, soft: float, sun: Floats, lamps: Floats, shadow: NDArray[np.float32], limits: NDArray[np.float32],
    axes: Floats, wide: int,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Return the light on a point, and its highlight. ``sun`` rows: direction, colour, light from above and below."""
    top = 0.5 + 0.5 * nz
    r, g, b = _between((sun[3, 0], sun[3, 1], sun[3, 2]), sun[2], top)
    slope = -(nx * sun[0, 0] + ny * sun[0, 1] + nz * sun[0, 2])
    shine = 0.0
    facing = slope if soft == 0.0 else (slope + soft) / (1.0 + soft)
    facing = max(0.0, facing)
    if facing > 0.0 and len(shadow) > 1:
        out = axes[4, 0]  # along the normal, against a surface that shades itself
        facing *= _lit(px + out * nx, py + out * ny, pz + out * nz, shadow, limits, axes, wide)
    if facing > 0.0 and gloss > 0.0:
        hx, hy, hz = -sun[0, 0] - vx, -sun[0, 1] - vy, -sun[0, 2] - vz
        size = np.sqrt(hx * hx + hy * hy + hz * hz)
        shine = max(0.0, nx * hx + ny * hy + nz * hz) / max(size, 1e-9)
        shine *= shine
        shine *= shine
        shine *= shine
        shine *= shine
        shine = gloss * shine * facing
    r, g, b = r + facing * sun[1, 0], g + facing * sun[1, 1], b + facing * sun[1, 2]
    for k in range(len(lamps)):
        x, y, z = lamps[k, 0] - px, lamps[k, 1] - py, lamps[k, 2] - pz
        far2 = x * x + y * y + z * z + 1e-9
        far = np.sqrt(far2)
        fall = max(0.0, (nx * x + ny * y + nz * z) / far) * max(0.0, z / far)
        fall *= lamps[k, 3] * 9.0 / (9.0 + far2)
        r, g, b = r + fall, g + fall, b + fall
    return r, g, b, shine


@kernel(inline=True)
def _shade_floor(
    x: float, y: float, camera: Floats, ground: Floats, sun: Floats, lamps: Floats, texels: Bytes, table: Ints,
    shadow: NDArray[np.float32], limits: NDArray[np.float32], axes: Floats, wide: int,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Return the colour of the floor at a point of the image, and its distance."""
    dx, dy, dz = _along(camera, x, y)
    away = -camera[0, 2] / dz
    px, py = camera[0, 0] + away * dx, camera[0, 1] + away * dy
    sx, sy = camera[1, 2] / dz, camera[2, 2] / dz
    ux, uy = away * (camera[1, 0] - dx * sx), away * (camera[1, 1] - dy * sx)
    vx, vy = away * (camera[2, 0] - dx * sy), away * (camera[2, 1] - dy * sy)
    scale = ground[3]
    area = max(ux * vy - uy * vx, uy * vx - ux * vy)
    spread = 0.5 * (area + max(ux * ux + uy * uy, vx * vx + vy * vy)) * scale * scale
    r, g, b = _texture(texels, table, 1, px * scale, py * scale, spread)
    far = away * np.sqrt(dx * dx + dy * dy + dz * dz)
    light = _light(px, py, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, sun, lamps, shadow, limits, axes, wide)
    return r * ground[0] * light[0], g * ground[1] * light[1], b * ground[2] * light[2], far


@kernel(inline=True)
def _texture_place(t: int, b0: float, b1: float, b2: float, away: float, edges: Floats, uv: Floats) -> Color:
    """Return the texture coordinates at a point of a triangle, and the squared width of a pixel there."""
    u = b0 * uv[t, 0, 0] + b1 * uv[t, 1, 0] + b2 * uv[t, 2, 0]
    v = b0 * uv[t, 0, 1] + b1 * uv[t, 1, 1] + b2 * uv[t, 2, 1]
    ux, uy, vx, vy = 0.0, 0.0, 0.0, 0.0
    for i in range(3):
        ux += edges[t, i, 0] * (uv[t, i, 0] - u)
        uy += edges[t, i, 1] * (uv[t, i, 0] - u)
        vx += edges[t, i, 0] * (uv[t, i, 1] - v)
        vy += edges[t, i, 1] * (uv[t, i, 1] - v)
    area = max(ux * vy - uy * vx, uy * vx - ux * vy)
    return u, v, 0.5 * away * away * (area + max(ux * ux + vx * vx, uy * uy + vy * vy))


@kernel(inline=True)
def _shade_triangle(
    t: int, x: float, y: float, camera: Floats, edges: Floats, faces: Ints, vertex: Floats, normal: Floats, uv: Floats,
    material: Ints, paint: Floats, sun: Floats, lamps: Floats, texels: Bytes, table: Ints, shadow: NDArray[np.float32],
    limits: NDArray[np.float32], axes: Floats, wide: int,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Return the colour of a triangle at a point of the image, and its distance."""
    e0 = edges[t, 0, 0] * x + edges[t, 0, 1] * y + edges[t, 0, 2]
    e1 = edges[t, 1, 0] * x + edges[t, 1, 1] * y + edges[t, 1, 2]
    e2 = edges[t, 2, 0] * x + edges[t, 2, 1] * y + edges[t, 2, 2]
    away = 1.0 / (e0 + e1 + e2)
    b0, b1, b2 = max(0.0, e0 * away), max(0.0, e1 * away), max(0.0, e2 * away)
    rest = 1.0 / max(b0 + b1 + b2, 1e-12)
    b0, b1, b2 = b0 * rest, b1 * rest, b2 * rest
    i, j, k = faces[t, 0], faces[t, 1], faces[t, 2]
    nx, ny, nz = _weighted(i, j, k, b0, b1, b2, normal)
    px, py, pz = _weighted(i, j, k, b0, b1, b2, vertex)
    vx, vy, vz = px - camera[0, 0], py - camera[0, 1], pz - camera[0, 2]
    far = np.sqrt(vx * vx + vy * vy + vz * vz) + 1e-12
    near = 1.0 / far
    vx, vy, vz = vx * near, vy * near, vz * near
    size = 1.0 / (np.sqrt(nx * nx + ny * ny + nz * nz) + 1e-12)
    nx, ny, nz = nx * size, ny * size, nz * size
    if nx * vx + ny * vy + nz * vz > 0.3:
        nx, ny, nz = -nx, -ny, -nz
    p = material[t]
    r, g, b = paint[p, 0], paint[p, 1], paint[p, 2]
    if paint[p, 3] >= 0.0:
        u, v, spread = _texture_place(t, b0, b1, b2, away, edges, uv)
        tr, tg, tb = _texture(texels, table, int(paint[p, 3]), u, v, spread)
        r, g, b = r * tr, g * tg, b * tb
    gloss, soft = paint[p, 4], paint[p, 5]
    light = _light(px, py, pz, nx, ny, nz, vx, vy, vz, gloss, soft, sun, lamps, shadow, limits, axes, wide)
    glow = light[3]
    return r * light[0] + glow, g * light[1] + glow, b * light[2] + glow, far


@kernel(parallel=True)
def shade(
    who: Labels, samples: Floats, camera: Floats, ray: Floats, floor: int, edges: Floats, faces: Ints, vertex: Floats,
    normal: Floats, uv: Floats, material: Ints, paint: Floats, ground: Floats, sky: Floats, sun: Floats, lamps: Floats,
    texels: Bytes, table: Ints, shadow: NDArray[np.float32], limits: NDArray[np.float32], axes: Floats, wide: int,
    haze: float, out: Bytes,
) -> None:  # fmt: skip
    """Write the image ``[H, W, 3]``: every surface in a pixel is shaded once and weighted by its samples."""
    count = who.shape[2]
    mid_x, mid_y = 0.0, 0.0
    for s in range(count):
        mid_x, mid_y = mid_x + samples[s, 0], mid_y + samples[s, 1]
    mid_x, mid_y = mid_x / count, mid_y / count
    for y in prange(who.shape[0]):
        for x in range(who.shape[1]):
            red, green, blue, done, alike = 0.0, 0.0, 0.0, 0, True
            for s in range(1, count):
                alike &= who[y, x, s] == who[y, x, 0]
            for s in range(count):
                t = who[y, x, s]
                if done & (1 << s):
                    continue
                cx, cy, n = x + mid_x, y + mid_y, count
                if alike:
                    done = (1 << count) - 1
                else:
                    mx, my, n = 0.0, 0.0, 0
                    for k in range(s, count):
                        if who[y, x, k] == t:
                            done |= 1 << k
                            mx, my, n = mx + samples[k, 0], my + samples[k, 1], n + 1
                    cx, cy = x + mx / n, y + my / n
                dx, dy, dz = _along(ray, cx, cy)
                size = np.sqrt(dx * dx + dy * dy + dz * dz)
                if t < 0:
                    r, g, b = _sky(dx / size, dy / size, dz / size, sky, texels, table)
                else:
                    if t == floor:
                        r, g, b, far = _shade_floor(
                            cx, cy, ray, ground, sun, lamps, texels, table, shadow, limits, axes, wide
                        )
                    else:
                        r, g, b, far = _shade_triangle(
                            t, cx, cy, camera, edges, faces, vertex, normal, uv, material, paint, sun, lamps, texels,
                            table, shadow, limits, axes, wide,
                        )  # fmt: skip
                    if haze > 0.0:
                        thin = far * far / (far * far + haze * haze)
                        r, g, b = _between((r, g, b), sky[0], thin)
                red, green, blue = red + n * r, green + n * g, blue + n * b
            for k in range(3):
                value = red if k == 0 else green if k == 1 else blue
                out[y, x, k] = int(255.0 * np.sqrt(min(1.0, max(0.0, value / count))) + 0.5)


@kernel(parallel=True)
def soften(image: Bytes) -> Bytes:
    """Return an image ``[H, W, 3]`` filtered with 1, 2, 1 along rows and columns."""
    high, wide = image.shape[0], image.shape[1]
    out = np.empty_like(image)
    for y in prange(high):
        above, below = max(0, y - 1), min(high - 1, y + 1)
        for x in range(wide):
            left, right = max(0, x - 1), min(wide - 1, x + 1)
            for k in range(3):
                total = np.int64(image[above, left, k]) + image[above, right, k]
                total += np.int64(image[below, left, k]) + image[below, right, k]
                total += 2 * (np.int64(image[above, x, k]) + image[below, x, k])
                total += 2 * (np.int64(image[y, left, k]) + image[y, right, k])
                out[y, x, k] = (total + 4 * np.int64(image[y, x, k]) + 8) // 16
    return out
