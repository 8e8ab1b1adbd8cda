"""An update against a match from scratch."""

from __future__ import annotations

from situgraph.matching import Matcher, match
from situgraph.scenegraph.graph import SceneGraph


def assert_as_from_scratch(matcher: Matcher, online: SceneGraph) -> None:
    """That the update finds the same candidates, in the same order; of many the first 30."""
    found = matcher.update(online)
    again = match(online, matcher.index, semantics=matcher.semantics)
    assert found.candidates == again.candidates
    for k in range(min(found.candidates, 30)):
        one, two = found.candidate(k), again.candidate(k)
        assert one is not None
        assert two is not None
        assert one.to_dict() == two.to_dict()
