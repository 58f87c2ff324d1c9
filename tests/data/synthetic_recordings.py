"""Synthetic recordings in every supported format, byte for byte as the programs of the field write them.

Twelve people cross a square: two groups of three walk east, three people walk west, three walk north. The tracks are
functions of time, so every format holds the same people at its own frame rate, units and columns.
"""

from __future__ import annotations

import gzip
import json
import math
import shutil
import sqlite3
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mcap_messages import McapRecording

from ros_bags import BagWriter

WALLS = "POLYGON ((-9 -9, 9 -9, 9 9, -9 9, -9 -9), (4 4, 5 4, 5 5, 4 5, 4 4))"
PEOPLE = 12
ROBOT = 40
SHORT = 8
"""Observed rows of a TrajNet test file; the rows after them are hidden."""


@dataclass(frozen=True)
class Walker:
    """A person who walks straight with a slight sway from ``begin`` to ``end`` [s]."""

    id: int
    begin: float
    end: float
    start: tuple[float, float]
    velocity: tuple[float, float]

    def at(self, time: float) -> tuple[float, float]:
        """Return the position [m] at a time [s]."""
        since = time - self.begin
        sway = 0.05 * math.sin(1.7 * since + self.id)
        (x, y), (vx, vy) = self.start, self.velocity
        speed = math.hypot(vx, vy)
        return x + vx * since - sway * vy / speed, y + vy * since + sway * vx / speed


def walkers() -> list[Walker]:
    """Return the people, by id from 1."""
    result = []
    for number in range(PEOPLE):
        place, family = number % 3, number // 3
        begin, end = 0.8 * number, 0.8 * number + 12.0
        if family < 2:  # two groups who walk side by side
            begin, end = 3.2 * family, 3.2 * family + 12.0
            start, velocity = (-7.0, -1.0 + 0.7 * place), (1.1 + 0.1 * family, 0.0)
        elif family == 2:
            start, velocity = (7.0, 1.5 + 0.8 * place), (-1.2 - 0.1 * place, 0.05)
        else:
            start, velocity = (-2.0 + 1.5 * place, -7.0), (0.1, 1.3)
        result.append(Walker(number + 1, begin, end, start, velocity))
    return result


def rows(fps: float, step: int = 1) -> list[tuple[int, int, float, float]]:
    """Return frame, id, x [m], y [m] of everyone at every ``step``-th frame, by frame, then id."""
    found = []
    for walker in walkers():
        first, last = math.ceil(walker.begin * fps / step), math.floor(walker.end * fps / step)
        for frame in range(first * step, last * step + 1, step):
            found.append((frame, walker.id, *walker.at(frame / fps)))
    return sorted(found)


def eth_obsmat(path: Path) -> None:
    """Write an ``obsmat.txt``: frame id x z y vx vz vy, 6 frames per row."""
    people = {walker.id: walker for walker in walkers()}
    lines = []
    for frame, id, x, y in rows(15.0, 6):
        vx, vy = people[id].velocity
        lines.append("".join(f"   {value:.7e}" for value in (frame, id, x, 0.0, y, vx, 0.0, vy)) + "\n")
    path.write_text("".join(lines), encoding="utf-8")


def sgan_text(path: Path) -> None:
    """Write a leave-one-out file: frame id x y with tabs, 10 frames per row."""
    path.write_text(
        "".join(f"{float(f)}\t{float(id)}\t{x:.10g}\t{y:.10g}\n" for f, id, x, y in rows(25.0, 10)), encoding="utf-8"
    )


def ind_tracks(path: Path) -> None:
    """Write ``NN_tracks.csv``, ``NN_tracksMeta.csv`` and ``NN_recordingMeta.csv`` of inD at 25 Hz."""
    head = "recordingId,trackId,frame,trackLifetime,xCenter,yCenter,heading,width,length\n"
    own = sorted(rows(25.0), key=lambda r: r[1])
    body = (f"7,{id},{frame},0,{x:.5f},{y:.5f},0.0,0.0,0.0\n" for frame, id, x, y in own)
    path.write_text(head + "".join(body), encoding="utf-8")
    kinds = "".join(f"7,{walker.id},{'bicycle' if walker.id > 9 else 'pedestrian'}\n" for walker in walkers())
    path.with_name("07_tracksMeta.csv").write_text("recordingId,trackId,class\n" + kinds)
    path.with_name("07_recordingMeta.csv").write_text("recordingId,frameRate\n7,25.0\n")


def jrdb_labels(path: Path) -> None:
    """Write 3D labels of JRDB at 15 Hz."""
    clouds: dict[str, list[object]] = {}
    for frame, id, x, y in rows(15.0):
        box = {"cx": x, "cy": y, "cz": 0.0, "h": 1.7, "l": 0.5, "w": 0.5, "rot_z": 0.0}
        clouds.setdefault(f"{frame:06d}.pcd", []).append({"label_id": f"pedestrian:{id}", "box": box})
    path.write_text(json.dumps({"labels": clouds}), encoding="utf-8")


def lcas_csv(path: Path) -> None:
    """Write a ``data.csv`` of L-CAS at 2.5 rows per second; the last column is the scene."""
    path.write_text("".join(f"{f},{id},{x:.4f},{y:.4f},0.6,0.8,0\n" for f, id, x, y in rows(2.5)), encoding="utf-8")


def wildtrack_frames(path: Path) -> None:
    """Write the JSON files of WILDTRACK at 2 Hz, and an empty frame; x is 0.6 x + 3 m, which fits its grid."""
    frames: dict[int, list[object]] = {}
    for frame, id, x, y in rows(10.0, 5):
        cell = 480 * round((y + 9.0) / 0.025) + round((0.6 * x + 6.0) / 0.025)
        frames.setdefault(frame, []).append({"personID": id, "positionID": cell, "views": []})
    path.parent.mkdir(exist_ok=True)
    for frame, people in (frames | {max(frames) + 5: []}).items():
        path.with_name(f"{frame:08d}.json").write_text(json.dumps(people))


def thor_magni_csv(path: Path) -> None:
    """Write a CSV file of THÖR-MAGNI: helmets with centroids or markers [mm], a robot and a box, at 100 Hz."""
    bodies = [f"Helmet_{walker.id}" for walker in walkers()] + ["DARKO_Robot", "LO1"]
    names = ["Frame", "Time"]
    for number, body in enumerate(bodies):
        marks = [f"{body} - {k} {axis}" for k in (1, 2) for axis in "XYZ"]
        names += marks + ([f"{body} Centroid_{axis}" for axis in "XYZ"] if number % 2 == 0 else [])
    found: dict[int, dict[str, tuple[float, float]]] = {}
    for frame, id, x, y in rows(100.0):
        found.setdefault(frame, {})[f"Helmet_{id}"] = 1000.0 * x, 1000.0 * y
    lines = [
        f"FILE_ID,THOR-Magni_{path.stem}", f"N_BODIES,{len(bodies)}", f"BODY_NAMES,{','.join(bodies)}",
        f"BODY_ROLES,{','.join(['Visitors-Alone'] * PEOPLE)},Robot,Object,,", ",".join(names),
    ]  # fmt: skip
    for frame, places in found.items():
        cells = [str(frame), f"{frame / 100.0:.2f}"]
        for number, body in enumerate(bodies):
            x, y = places.get(body, (3000.0, 2000.0)) if body in places or body not in bodies[:PEOPLE] else ("", "")
            marks = (
                ["", "", ""] * 2
                if x == ""
                else [f"{x - 20.0:.2f}", f"{y:.2f}", "1", f"{x + 20.0:.2f}", f"{y:.2f}", "1"]
            )
            cells += marks + ([str(x), str(y), "1" if x != "" else ""] if number % 2 == 0 else [])
        lines += [",".join(cells)] * (2 if frame == 200 else 1)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def trajnet_test(path: Path) -> None:
    """Write a TrajNet test file: 12 frames per row, "?" for every row after the eighth of a track."""
    count: dict[int, int] = {}
    lines = []
    for frame, id, x, y in rows(30.0, 12):
        count[id] = count.get(id, 0) + 1
        lines.append(f"{frame} {float(id)} {x:.3f} {y:.3f}\n" if count[id] <= SHORT else f"{frame} {float(id)} ? ?\n")
    path.write_text("".join(lines), encoding="utf-8")


def ucy_vsp(path: Path) -> None:
    """Write an ``annotation.vsp``: one spline per person, a control point every second, pixels."""
    lines = [f"{PEOPLE} - the number of splines\n"]
    for walker in walkers():
        frames = range(round(25 * walker.begin), round(25 * walker.end) + 1, 25)
        lines.append(f"{len(frames)} - Num of control points\n")
        for frame in frames:
            x, y = walker.at(frame / 25.0)
            lines.append(f"{30 * x:.6f} {25 * y:.6f} {frame} 90.000000 - (2D point, m_id)\n")
    path.write_text("".join(lines), encoding="utf-8")


def sdd_annotations(path: Path) -> None:
    """Write an ``annotations.txt``: boxes in pixels at 30 fps; the first row of every track is marked lost."""
    lines = []
    for walker in walkers():
        own = [(frame, x, y) for frame, id, x, y in rows(30.0) if id == walker.id]
        label = "Biker" if walker.id > 9 else "Pedestrian"
        for k, (frame, x, y) in enumerate(own):
            left, top = round(400 + 30 * x), round(400 - 30 * y)
            box = f"{left - 10} {top - 20} {left + 10} {top + 20}"
            lines.append(f'{walker.id - 1} {box} {frame} {int(k == 0)} 0 {int(k % 12 > 0)} "{label}"\n')
    path.write_text("".join(lines), encoding="utf-8")


def cvml_boxes(path: Path) -> None:
    """Write CVML at 25 Hz: boxes with feet of 20 pixels per metre, and a group that is no person."""
    by_frame: dict[int, list[str]] = {}
    for frame, id, x, y in rows(25.0):
        box = f'<box xc="{20 * x + 400:.4f}" yc="{20 * y + 360:.4f}" w="20" h="80"/>'
        by_frame.setdefault(frame, []).append(f'<object id="{id}"><orientation>90</orientation>{box}</object>')
    text = '<?xml version="1.0" encoding="UTF-8"?>\n<!-- hall --><dataset name="square">\n'
    for frame, objects in sorted(by_frame.items()):
        group = '<grouplist><group id="1"><box xc="1" yc="1" w="3" h="3"/></group></grouplist>'
        text += f'<frame number="{frame}"><objectlist>{"".join(objects)}</objectlist>{group}</frame>\n'
    path.write_text(text + "</dataset>\n", encoding="utf-8")


def petrack_metres(path: Path) -> None:
    """Write a PeTrack file in metres at 25 fps with a header."""
    head = "# PeTrack project: synthetic.pet\n# framerate: 25 fps\n# id frame x/m y/m z/m\n"
    body = (f"{id} {frame} {x:.4f} {y:.4f} 1.7600\n" for frame, id, x, y in sorted(rows(25.0), key=lambda r: r[1]))
    path.write_text(head + "".join(body), encoding="utf-8")


def petrack_centimetres(path: Path) -> None:
    """Write a PeTrack file in centimetres at 25 fps with a header."""
    head = "# PeTrack project: synthetic.pet\n# framerate: 25 fps\n# id frame x/cm y/cm z/cm\n"
    body = (f"{id} {f} {100 * x:.2f} {100 * y:.2f} 176.00\n" for f, id, x, y in sorted(rows(25.0), key=lambda r: r[1]))
    path.write_text(head + "".join(body), encoding="utf-8")


def hermes(path: Path) -> None:
    """Write a HERMES file: id frame x y z in centimetres at 16 fps, no header."""
    ordered = sorted(rows(16.0), key=lambda row: row[1])
    path.write_text(
        "".join(f"{id} {f} {100 * x:.3f} {100 * y:.3f} 183.02\n" for f, id, x, y in ordered), encoding="utf-8"
    )


def juelich_hdf5(path: Path) -> None:
    """Write an HDF5 file of the Jülich archive at 25 fps with a walkable area."""
    import h5py

    kind = [("id", "<i8"), ("frame", "<i8"), ("x", "<f8"), ("y", "<f8"), ("z", "<f8")]
    table = np.array([(id, frame, x, y, 1.76) for frame, id, x, y in rows(25.0)], dtype=kind)
    with h5py.File(path, "w") as file:
        file.attrs["file_version"] = "1.0.0"
        file.attrs["wkt_geometry"] = WALLS
        data = file.create_dataset("trajectory", data=table, chunks=True)
        data.attrs["fps"] = 25.0
        for axis in "xyz":
            data.attrs[axis] = f"pedestrian {axis}-coordinate (meter [m])"


def jupedsim_sqlite(path: Path) -> None:
    """Write the output of JuPedSim: every second frame of a simulation at 50 fps."""
    base = sqlite3.connect(path)
    base.executescript(
        "CREATE TABLE trajectory_data (frame INTEGER NOT NULL, id INTEGER NOT NULL, pos_x REAL NOT NULL,"
        " pos_y REAL NOT NULL, ori_x REAL NOT NULL, ori_y REAL NOT NULL);"
        "CREATE TABLE metadata(key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);"
        "CREATE TABLE geometry(hash INTEGER NOT NULL, wkt TEXT NOT NULL);"
        "CREATE INDEX frame_id_idx ON trajectory_data(frame, id);"
    )
    base.executemany("INSERT INTO trajectory_data VALUES (?, ?, ?, ?, 1.0, 0.0)", rows(50.0, 2))
    base.executemany("INSERT INTO metadata VALUES (?, ?)", [("version", "2"), ("fps", "50.0"), ("xmin", "-9.0")])
    base.execute("INSERT INTO geometry VALUES (1, ?)", (WALLS,))
    base.commit()
    base.close()


def trajnetpp(path: Path) -> None:
    """Write TrajNet++ lines: a scene per person, then tracks, 10 frames per row, 2.5 rows per second."""
    lines = []
    for walker in walkers():
        own = [frame for frame, id, _, _ in rows(25.0, 10) if id == walker.id]
        scene = {"id": walker.id - 1, "p": walker.id, "s": own[0], "e": own[20], "fps": 2.5, "tag": [3, [2]]}
        lines.append(json.dumps({"scene": scene}))
    for frame, id, x, y in rows(25.0, 10):
        lines.append(json.dumps({"track": {"f": frame, "p": id, "x": round(x, 2), "y": round(y, 2)}}))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def social_ways(path: Path) -> None:
    """Write the arrays of Social Ways: 8 observed and 12 future rows of every person at 0.4 s."""
    place = np.array([[walker.at(walker.begin + 0.4 * k) for k in range(20)] for walker in walkers()])
    times = np.array([[round(walker.begin / 0.4)] for walker in walkers()], dtype=float)
    np.savez(path.with_suffix(".npz"), obsvs=place[:, :8], preds=place[:, 8:], times=times)
    path.with_suffix(".npz").replace(path)


def csv_table(path: Path) -> None:
    """Write a table as single-file experiments have it: ID,Frame,x,y,v_x,v_y, 10 frames per row at 25 fps."""
    people = {walker.id: walker for walker in walkers()}
    lines = ["ID,Frame,x,y,v_x,v_y\n"]
    for frame, id, x, y in sorted(rows(25.0, 10), key=lambda row: row[1]):
        vx, vy = people[id].velocity
        lines.append(f"{id},{frame},{x:.15f},{y:.15f},{vx:.15f},{vy:.15f}\n")
    path.write_text("".join(lines), encoding="utf-8")


def csv_filtered(path: Path) -> None:
    """Write a table as CITR has it: id,frame,label,x_est,y_est,vx_est,vy_est, every frame at 29.97 fps."""
    lines = ["id,frame,label,x_est,y_est,vx_est,vy_est\n"]
    lines += [f"{id},{frame},ped,{x:.12f},{y:.12f},1.0,0.0\n" for frame, id, x, y in rows(29.97)]
    path.write_text("".join(lines), encoding="utf-8")


def csv_times(path: Path) -> None:
    """Write a table of times [s] without frames, 0.4 s per row."""
    lines = ["track_id;time;pos_x;pos_y\n"]
    lines += [f"{id};{100 + frame / 25.0:.2f};{x:.6f};{y:.6f}\n" for frame, id, x, y in rows(25.0, 10)]
    path.write_text("".join(lines), encoding="utf-8")


def parquet(path: Path) -> None:
    """Write a Parquet table of id, frame, time [s], x, y, 10 frames per row at 25 fps."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    frame, id, x, y = zip(*rows(25.0, 10), strict=True)
    columns = {"id": id, "frame": frame, "time": [item / 25.0 for item in frame], "x": x, "y": y}
    pq.write_table(pa.table({name: list(column) for name, column in columns.items()}), path)


def mot_boxes(path: Path) -> None:
    """Write boxes of MOT Challenge at 25 Hz: 20 pixels per metre; the feet are in the middle of the lower edge."""
    (path.parent / "seqinfo.ini").write_text("[Sequence]\nname=square\nframeRate=25\n")
    text = "".join(f"{f},{id},{20 * x + 400:.2f},{20 * y + 400:.2f},10,40,1,1,0.9\n" for f, id, x, y in rows(25.0))
    path.write_text(text + "1,90,5,5,10,40,0,1,0.1\n2,91,5,5,10,40,1,9,1\n", encoding="utf-8")


def kitti_labels(path: Path) -> None:
    """Write KITTI tracking labels at 10 Hz: x to the right, z forward."""
    text = "".join(
        f"{f} {id} Pedestrian 0 0 -1.5 100 100 120 160 1.7 0.6 0.6 {-y:.4f} 1.6 {x:.4f} 0.1\n"
        f"{f} -1 DontCare -1 -1 -10 1 2 3 4 -1 -1 -1 -1000 -1000 -1000 -10\n"
        for f, id, x, y in rows(10.0)
    )
    path.write_text(text, encoding="utf-8")


def vadere_footsteps(path: Path) -> None:
    """Write footsteps of Vadere of 0.2 s, at times that no step of the tracks shares."""
    text = "#IDXCOL=2,DATACOL=6,SEP=' '\n"
    text += "pedestrianId simTime endTime-PID1 startX-PID1 startY-PID1 endX-PID1 endY-PID1 targetId-PID2\n"
    for walker in walkers():
        count = round((walker.end - walker.begin) / 0.2)
        for begin, end in ((walker.begin + 0.2 * k, walker.begin + 0.2 * (k + 1)) for k in range(count)):
            (x0, y0), (x1, y1) = walker.at(begin), walker.at(end)
            text += f"{walker.id} {begin:.4f} {end:.4f} {x0:.6f} {y0:.6f} {x1:.6f} {y1:.6f} -1\n"
    path.write_text(text, encoding="utf-8")


def viswalk_records(path: Path) -> None:
    """Write the pedestrian record of Viswalk every 0.2 s."""
    text = "$VISION\n* File: square.inpx\n$VERSION:VERSNR;FILETYPE\n22.00;Pedestrian Record\n\n"
    text += "$PEDESTRIAN:SIMSEC;NO;SPEED;COORDCENTX;COORDCENTY\n"
    text += "".join(f"{f / 5:.2f};{id};4.8;{x:.4f};{y:.4f}\n" for f, id, x, y in rows(5.0))
    path.write_text(text, encoding="utf-8-sig")


def pathfinder_csv(path: Path) -> None:
    """Write occupants of Pathfinder every 0.5 s, with a line of units."""
    text = '"t","id","name","active","x","y","z"\n"s","","","","m","m","m"\n'
    text += "".join(f'{f / 2:.1f},{id},"{id:05d}",1,{x:.4f},{y:.4f},0.0\n' for f, id, x, y in rows(2.0))
    path.write_text(text, encoding="utf-8")


def edinburgh_tracks(path: Path) -> None:
    """Write tracks of the Edinburgh Informatics Forum at 9 Hz, 24.7 mm per pixel, with a repeated frame."""
    tracks: dict[int, list[str]] = {}
    for frame, id, x, y in rows(9.0):
        place = f"[{round((x + 20) / 0.0247)} {round((y + 20) / 0.0247)} {frame}]"
        tracks.setdefault(id, []).extend([place] * (2 if frame == 50 else 1))
    text = f"% Total number of trajectories in file are {len(tracks)}\n\n"
    for id, places in tracks.items():
        text += f"Properties.R{id}=[{len(places)} 1 2 3.5 ];\n TRACK.R{id}=[{';'.join(places)}];\n"
    path.write_text(text, encoding="utf-8")


def grand_central(path: Path) -> None:
    """Write the folder of Grand Central: one file a person with y, x and frame, every 20 frames at 25 Hz."""
    path.parent.mkdir(exist_ok=True)
    for walker in walkers():
        own = [(f, x, y) for f, id, x, y in rows(25.0, 20) if id == walker.id]
        text = "".join(f"{round(50 * y + 1000)}\n{round(50 * x + 1000)}\n{f}\n" for f, x, y in own)
        path.with_name(f"{walker.id:06d}.txt").write_text(text, encoding="utf-8")


def four_rows(path: Path) -> None:
    """Write four rows of Social LSTM: frames, persons, y and x."""
    columns = list(zip(*rows(25.0, 10), strict=True))
    order = [columns[0], columns[1], columns[3], columns[2]]
    path.write_text("".join(",".join(f"{value:.7g}" for value in row) + "\n" for row in order), encoding="utf-8")


def atc_csv(path: Path) -> None:
    """Write a day of the ATC shopping center in millimetres, at 25 Hz."""
    begin = 1_351_039_728.0
    text = "".join(
        f"{begin + f / 25:.3f},{id},{1000 * x:.1f},{1000 * y:.1f},1700.5,1200,0.1,0.2\n" for f, id, x, y in rows(25.0)
    )
    path.write_text(text, encoding="utf-8")


def bag(storage: str) -> Callable[[Path], None]:
    """Return a writer of a ROS bag: people every 0.1 s, in the frame of a robot that drives at 0.5 m/s."""

    def write(path: Path) -> None:
        by_frame: dict[int, dict[int, tuple[float, float]]] = {}
        for frame, id, x, y in rows(10.0):
            by_frame.setdefault(frame, {})[id] = x - 0.05 * frame, y
        folder = path.with_name(f"{path.stem}-{storage}")
        with BagWriter(path if storage == "ros1" else folder, storage) as writer:
            for frame, persons in by_frame.items():
                writer.odometry(0.1 * frame, 0.05 * frame, 0.0)
                writer.people(0.1 * frame, "base_link", persons)
        if storage != "ros1":
            writer.file.rename(path)
            shutil.rmtree(folder)

    return write


def packed(write: Callable[[Path], None]) -> Callable[[Path], None]:
    """Return a writer of a text in gzip."""

    def write_packed(path: Path) -> None:
        plain = path.with_suffix("")
        write(plain)
        path.write_bytes(gzip.compress(plain.read_bytes(), mtime=0))
        plain.unlink()

    return write_packed


def episode(path: Path) -> None:
    """Write a recorded trial: /people every 0.1 s and the odometry of one robot every 0.05 s."""
    with McapRecording(path) as recording:
        by_frame: dict[int, dict[int, tuple[float, float]]] = {}
        for frame, id, x, y in rows(10.0):
            by_frame.setdefault(frame, {})[id] = x, y
        for frame, persons in by_frame.items():
            recording.people(100_000_000 * frame, persons)
            for now in (100_000_000 * frame, 100_000_000 * frame + 50_000_000):
                recording.odometry(now, -5.0 + 0.5e-9 * now, 0.0)
        recording.metadata(format="1", walls="[[[0, 6], [4, 6]]]", robots=json.dumps([{"name": "robot", "id": ROBOT}]))


@dataclass(frozen=True)
class Synthetic:
    """One synthetic file.

    Fields:
        format: name of the format that must be detected.
        write: writes the file.
        step: frames between two rows of a track.
        fps: frames per second of the frame counter [1/s].
        units: units after loading.
        scale: pixels or metres of the loaded tracks per metre, along x and y.
        options: options that are needed to load it.
        robots: ids of robots.
    """

    format: str
    write: Callable[[Path], None]
    step: int
    fps: float
    units: str = "m"
    scale: tuple[float, float] = (1.0, 1.0)
    options: tuple[tuple[str, object], ...] = ()
    robots: frozenset[int] = frozenset()


SYNTHETIC = {
    "obsmat.txt": Synthetic("eth-obsmat", eth_obsmat, 6, 15.0),
    "crowds.txt": Synthetic("sgan", sgan_text, 10, 25.0),
    "gates_2.txt": Synthetic("sgan", trajnet_test, 12, 30.0),
    "annotation.vsp": Synthetic("ucy-vsp", ucy_vsp, 1, 25.0, "px", (30.0, 25.0)),
    "annotations.txt": Synthetic("sdd", sdd_annotations, 1, 30.0, "px", (30.0, -30.0)),
    "petrack_m.txt": Synthetic("petrack", petrack_metres, 1, 25.0),
    "petrack_cm.txt": Synthetic("petrack", petrack_centimetres, 1, 25.0),
    "uo-050.txt": Synthetic("petrack", hermes, 1, 16.0),
    "00_01a.h5": Synthetic("juelich-hdf5", juelich_hdf5, 1, 25.0),
    "trajectories.sqlite": Synthetic("jupedsim", jupedsim_sqlite, 2, 50.0),
    "hotel.ndjson": Synthetic("trajnetpp", trajnetpp, 10, 25.0),
    "data_8_12.npz": Synthetic("social-ways", social_ways, 1, 2.5, options=(("fps", 2.5),)),
    "07_tracks.csv": Synthetic("ind", ind_tracks, 1, 25.0),
    "cubberly.json": Synthetic("jrdb", jrdb_labels, 1, 15.0),
    "data.csv": Synthetic("lcas", lcas_csv, 1, 2.5),
    "wildtrack/00000030.json": Synthetic("wildtrack", wildtrack_frames, 5, 10.0),
    "THOR-Magni_120522_SC1A_R1.csv": Synthetic("thor-magni", thor_magni_csv, 1, 100.0, robots=frozenset({PEOPLE + 1})),
    "n56.csv": Synthetic("csv", csv_table, 10, 25.0),
    "citr.csv": Synthetic("csv", csv_filtered, 1, 29.97, options=(("fps", 29.97),)),
    "times.csv": Synthetic("csv", csv_times, 1, 2.5),
    "tracks.parquet": Synthetic("parquet", parquet, 10, 25.0),
    "episode.mcap": Synthetic("episode", episode, 1, 10.0, robots=frozenset({ROBOT})),
    "bag.db3": Synthetic("rosbag2", bag("sqlite3"), 1, 10.0, robots=frozenset({PEOPLE + 1})),
    "bag.bag": Synthetic("rosbag1", bag("ros1"), 1, 10.0, robots=frozenset({PEOPLE + 1})),
    "cvml.xml": Synthetic("cvml", cvml_boxes, 1, 25.0, "px", (20.0, 20.0), options=(("fps", 25.0),)),
    "mot.txt": Synthetic("mot", mot_boxes, 1, 25.0, "px", (20.0, 20.0)),
    "kitti.txt": Synthetic("kitti", kitti_labels, 1, 10.0),
    "square.traj": Synthetic("vadere", vadere_footsteps, 1, 2.5),
    "square.pp": Synthetic("viswalk", viswalk_records, 1, 5.0),
    "occupants.csv": Synthetic("csv", pathfinder_csv, 1, 2.0),
    "tracks.01Sep.txt": Synthetic("edinburgh", edinburgh_tracks, 1, 9.0),
    "grand-central/000001.txt": Synthetic("grand-central", grand_central, 20, 25.0, "px", (50.0, 50.0)),
    "pixel_pos.csv": Synthetic("four-rows", four_rows, 10, 25.0),
    "atc-20121024.csv": Synthetic("atc", atc_csv, 1, 25.0),
    "packed.txt.gz": Synthetic("sgan", packed(sgan_text), 10, 25.0),
}


def write_all(folder: Path) -> dict[str, Path]:
    """Write every synthetic recording and return the paths by file name."""
    for name, item in SYNTHETIC.items():
        item.write(folder / name)
    return {name: folder / name for name in SYNTHETIC}
