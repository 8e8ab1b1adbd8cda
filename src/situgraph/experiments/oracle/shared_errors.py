"""Objects of one wall share part of their error: section 6, written out as normal densities."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping, Sequence

import networkx as nx
import numpy as np
from scipy.stats import multivariate_normal

from situgraph.experiments.oracle.definition import Definition
from situgraph.geometry.poses import Array


def wall_groups(walls: Mapping[int, Iterable[Hashable]]) -> list[list[int]]:
    """Sets of two and more things that have a wall in common, directly or through others."""
    graph: nx.Graph[Hashable] = nx.Graph()
    graph.add_edges_from((("thing", k), ("wall", w)) for k, mine in walls.items() for w in mine)
    groups = [
        sorted(node[1] for node in part if isinstance(node, tuple) and node[0] == "thing")
        for part in nx.connected_components(graph)
    ]
    return [g for g in groups if len(g) > 1]


def log_ratio(errors: Sequence[Array], c: Definition) -> float:
    """Ln of the joint density of the errors (each (2,)) of one wall against independent ones."""
    bell = np.array([(1 - c.object_tail_share) * _alone(x, c) for x in errors])
    disc = np.array([c.object_tail_share * _disc(x, c) for x in errors])
    every = set(range(len(errors)))
    apart = float(np.prod(bell + disc))
    total = 0.0
    for told in [every, *(every - {k} for k in every)]:
        tail = every - told
        weight = (1 - c.object_tail_share) ** len(told) * float(np.prod(disc[list(tail)]))
        total += weight * _joint([errors[k] for k in sorted(told)], c)
        apart -= float(np.prod(bell[list(told)])) * float(np.prod(disc[list(tail)]))
    return math.log((total + max(apart, 0.0)) / float(np.prod(bell + disc)))


def most_log_ratio(count: int, c: Definition) -> float:
    """The largest of so many errors, none of them of the tail: all are zero."""
    zero = [np.zeros(2)] * count
    return math.log(_joint(zero, c)) - count * math.log(_alone(zero[0], c))


def _joint(errors: Sequence[Array], c: Definition) -> float:
    """The normal density of errors with a common part, both axes."""
    shared = np.full((len(errors), len(errors)), c.object_shared)
    covariance = c.object_sigma**2 * (shared + (1 - c.object_shared) * np.eye(len(errors)))
    axes = np.array(errors).T
    return math.prod(float(multivariate_normal.pdf(axis, cov=covariance)) for axis in axes)


def _alone(error: Array, c: Definition) -> float:
    return _joint([error], c)


def _disc(error: Array, c: Definition) -> float:
    inside = float(np.linalg.norm(error)) <= c.object_tail_radius
    return inside / (math.pi * c.object_tail_radius**2)
