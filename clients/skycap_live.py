"""Client of `skycap serve`; docs/reference/live-protocol.md describes the messages. Requires only
Python 3.8.

    with Survey("unix:survey.sock") as survey:
        answer = survey.next()
        while answer["view"]:
            depth, pose = my_drone.measure(answer["view"])
            answer = survey.add_depth(depth, width, height, unit=0.001, pose=pose)
            # en-route scans (answer["frames"]) are added with en_route=True
            if answer.get("warning") == "pose":
                my_drone.hold_position()
        print(survey.finish())
"""
import json
import socket
import struct
import zlib


class Refused(Exception):
    """The server rejected a message; the survey is unchanged."""


class Survey:
    def __init__(self, address, timeout=600.0):
        """Connects to `address`, as printed by the server: unix:PATH or tcp:127.0.0.1:PORT."""
        kind, place = address.split(":", 1)
        if kind == "unix":
            self._socket = socket.socket(socket.AF_UNIX)
            where = place
        else:
            host, port = place.rsplit(":", 1)
            self._socket = socket.socket(socket.AF_INET)
            where = (host, int(port))
        self._socket.settimeout(timeout)
        self._socket.connect(where)
        self.hello = self._ask({"type": "hello"})
        self._count(self.hello)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    def next(self):
        """Returns the next view, as printed by `skycap next --json`."""
        return self._ask({"type": "next"})

    def add_points(self, xyz, pose, pixels=None, pose_sigma=None, pose_covariance=None,
                   en_route=False):
        """Adds a scan of points in the mission frame: bytes of float32 x y z, row by row. `pose` of the
        sensor's optical frame: x y z qx qy qz qw, or 12 numbers of a row-major matrix. `pixels`:
        bytes of ascending uint32, row * width + column of the mission's camera, for each point.
        Uncertainty of the pose: `pose_sigma`, standard deviations (metres, degrees) along and about
        each axis; or `pose_covariance` of x y z rx ry rz along and about the axes of the mission
        frame [m, rad], as in ROS: 36 numbers row by row, or the 21 of the upper triangle.
        `en_route`: the scan was taken en route to the proposed view."""
        header = {"format": "points", "points": len(xyz) // 12, "has_pixels": pixels is not None}
        return self._add(header, pose, bytes(xyz) + bytes(pixels or b""), pose_sigma,
                         pose_covariance, en_route)

    def add_cloud(self, xyz, pose, pose_sigma=None, pose_covariance=None, en_route=False):
        """Adds a scan of points in the sensor's optical frame: bytes of float32 x y z, in any order.
        The server projects each point into a pixel of the mission's camera."""
        header = {"format": "cloud", "points": len(xyz) // 12}
        return self._add(header, pose, bytes(xyz), pose_sigma, pose_covariance, en_route)

    def add_depth(self, depth, width, height, unit, pose, lens=None, pose_sigma=None,
                  pose_covariance=None, en_route=False):
        """Adds a depth image: bytes of uint16, row by row, in steps of `unit` metres; 0 and 65535 are
        no-return pixels. `lens`: camera intrinsics fx fy cx cy, optionally followed by k1 k2 p1 p2
        k3 (default: the mission's camera)."""
        header = {"format": "depth", "width": width, "height": height, "unit": unit}
        if lens is not None:
            header["lens"] = list(lens)
        return self._add(header, pose, bytes(depth), pose_sigma, pose_covariance, en_route)

    def refuse(self, answer, reason):
        """Rejects the view in `answer` and returns another."""
        return self._ask({"type": "refuse", "id": answer["id"], "reason": reason})

    def finish(self):
        """Ends the survey; the server writes the mission package and exits."""
        return self._ask({"type": "finish"})["text"]

    def _count(self, answer):
        self._scans = answer["scans"]
        self._en_route = answer.get("en_route", 0)

    def _add(self, header, pose, payload, pose_sigma, pose_covariance, en_route):
        header = {"type": "scan", "number": self._scans, "pose": list(pose), **header}
        if en_route:
            header["en_route"] = self._en_route
        if pose_sigma is not None:
            header["pose_sigma"] = list(pose_sigma)
        if pose_covariance is not None:
            header["pose_covariance"] = list(pose_covariance)
        answer = self._ask(header, payload)
        self._count(answer)
        return answer

    def _ask(self, header, payload=b""):
        text = json.dumps(header).encode()
        lengths = struct.pack("<III", len(text), len(payload), zlib.crc32(text + payload))
        self._socket.sendall(lengths + text + payload)
        header_size, payload_size, checksum = struct.unpack("<III", self._receive(12))
        body = self._receive(header_size + payload_size)
        if zlib.crc32(body) != checksum:
            raise ConnectionError("the answer is damaged (checksum)")
        answer = json.loads(body[:header_size])
        if answer["type"] == "error":
            raise Refused(answer["what"])
        return answer

    def _receive(self, size):
        data = bytearray()
        while len(data) < size:
            chunk = self._socket.recv(min(size - len(data), 1 << 20))
            if not chunk:
                raise ConnectionError("connection closed by the server")
            data += chunk
        return bytes(data)
