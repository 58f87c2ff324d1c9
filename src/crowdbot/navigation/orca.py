"""ORCA as a navigator: the model of walking people steers the robot, through the limits of its drive."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot import models
from crowdbot.core import InputError, Scene, Twist, wrap
from crowdbot.core.kernels import kernel
from crowdbot.core.geometry import nearest_on_segment

from .navigator import Navigator, Observation

__all__ = ["ORCA"]

Floats = NDArray[np.float64]

@kernel
def _cost(forward, turn, v0, w0, a, alpha, heading, tx, ty, people, walls, radius, steps, h, match, margin, weight, hard, skin, tunnel, wallw):
    x = y = 0.0
    th = heading
    v, w = v0, w0
    danger = 0.0
    soft = 0.0
    wall = 0.0
    mis = 0.0
    T = steps * h
    speed = math.sqrt(tx * tx + ty * ty)
    for k in range(steps):
        v += min(max(forward - v, -a * h), a * h)
        w += min(max(turn - w, -alpha * h), alpha * h)
        ox, oy = x, y
        x += v * math.cos(th + 0.5 * w * h) * h
        y += v * math.sin(th + 0.5 * w * h) * h
        th += w * h
        t = (k + 1) * h
        fade = 1.0 - k / steps
        if k + 1 == match:
            mis = math.sqrt((x - tx * t) ** 2 + (y - ty * t) ** 2) / t
            if speed > 0.05:
                mis += tunnel * (speed - (tx * math.cos(th) + ty * math.sin(th)))
        for n in range(len(people)):
            # swept
            px, py = people[n, 0] + people[n, 2] * (t - h) - ox, people[n, 1] + people[n, 3] * (t - h) - oy
            qx, qy = people[n, 0] + people[n, 2] * t - x, people[n, 1] + people[n, 3] * t - y
            nx, ny = nearest_on_segment(0.0, 0.0, px, py, qx, qy)
            gap = math.sqrt(nx * nx + ny * ny) - radius - people[n, 4]
            if gap < margin:
                soft = max(soft, fade * (margin - gap) / margin)
            if gap < skin:
                danger = max(danger, fade)
        for n in range(len(walls)):
            nx, ny = nearest_on_segment(x, y, walls[n, 0], walls[n, 1], walls[n, 2], walls[n, 3])
            gap = math.sqrt((nx - x) ** 2 + (ny - y) ** 2) - radius
            if gap < 0.1:
                wall = max(wall, fade * (0.1 - gap) / 0.1)
    return mis + weight * soft + hard * danger + wallw * wall

@kernel
def _select(forwards, turns, v0, w0, a, alpha, heading, tx, ty, people, walls, radius, steps, h, match, margin, weight, hard, skin, tunnel, wallw):
    best = np.inf
    bf, bt = 0.0, 0.0
    for f in forwards:
        for t in turns:
            c = _cost(f, t, v0, w0, a, alpha, heading, tx, ty, people, walls, radius, steps, h, match, margin, weight, hard, skin, tunnel, wallw)
            if c < best:
                best, bf, bt = c, f, t
    return bf, bt

@dataclass(frozen=True)
class ORCA(Navigator):
    """x"""

    speed: float = 1.0
    time_horizon: float = 1.5
    safety: float = 0.05
    neighbor_distance: float = 6.0
    max_neighbors: int = 15
    time_horizon_walls: float = 1.0
    share: float = 0.5
    reaction: float = 0.3
    look: float = 1.5
    window: float = 0.5
    match: float = 0.5
    margin: float = 0.3
    weight: float = 1.0
    reverse: float = 0.0
    tunnel: float = 0.5
    hard: float = 0.0
    skin: float = 0.05
    wallw: float = 20.0
    tau: float = 0.5

    def act(self, observation: Observation) -> Twist:
        velocity = self.velocity(observation)
        if self.window == 0:
            speed = math.hypot(*velocity)
            if speed < 0.02:
                return Twist()
            angle = wrap(math.atan2(velocity[1], velocity[0]) - observation.heading)
            return Twist(max(0.0, speed * math.cos(angle)), observation.turn_by(angle))
        return self.select(observation, velocity)

    def select(self, o: Observation, target: Floats) -> Twist:
        L = o.limits
        dv, dw = L.max_acceleration * self.window, L.max_turn_acceleration * self.window
        v = np.unique(np.append(np.linspace(max(-self.reverse, o.twist.forward - dv), min(self.speed, L.max_speed, o.twist.forward + dv), 9), 0.0 if abs(o.twist.forward)<=dv else o.twist.forward))
        w = np.linspace(max(-L.max_turn_rate, o.twist.turn - dw), min(L.max_turn_rate, o.twist.turn + dw), 13)
        near = np.hypot(*(o.people.position - o.position).T) < 5.0
        P = np.concatenate([o.people.position - o.position, o.people.velocity, o.people.radius[:, None]], axis=1)[near]
        S = o.walls.segments() - np.tile(o.position, 2) if len(o.walls) else np.zeros((0, 4))
        f, t = _select(v, w, o.twist.forward, o.twist.turn, L.max_acceleration, L.max_turn_acceleration, o.heading, target[0], target[1], np.ascontiguousarray(P), np.ascontiguousarray(S), o.radius,
            round(self.look / 0.1), 0.1, round(self.tau / 0.1), self.margin, self.weight, self.hard, self.skin, self.tunnel, self.wallw)
        return Twist(float(f), float(t))

    def velocity(self, observation: Observation) -> Floats:
        people = observation.people
        count = len(people)
        top = min(self.speed, observation.limits.max_speed)
        away = np.array(observation.goal) - observation.position
        distance = observation.distance
        wish = away * (min(top, distance / 0.5, observation.braking_speed(distance)) / max(distance, 1e-9))
        position = np.concatenate([observation.position[None], people.position])
        velocity = np.concatenate([observation.velocity[None], people.velocity])
        radius = np.concatenate([[observation.radius + self.safety], people.radius])
        external = np.full(count + 1, self.share == 1.0)
        external[0] = False
        scene = Scene.of(
            position, velocity, radius=radius, preferred_velocity=np.concatenate([wish[None], people.velocity]),
            max_speed=top, external=external, walls=observation.walls,
        )
        model = models.ORCA(self.neighbor_distance, self.max_neighbors, self.time_horizon, self.time_horizon_walls)
        return model.velocity(scene, max(self.reaction, observation.dt))[0, 0]
