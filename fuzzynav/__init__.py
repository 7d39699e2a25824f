"""Autonomous navigation of wheeled robots: the package behind the course notebooks, a room for every topic.

Imports run one way, from the top of this list to its end; the number is the chapter that teaches the room.

- `geometry`      angles and poses in the plane                                    01
- `checks`        the few checks of input
- `data`          where the maps, rule bases, printed numbers and results lie
- `control`       what a controller sees, and what it must answer                  04, 06
- `documents`     what the documents printed: claims, figures, tables, equations
- `batch`         sweeps over thousands of cases
- `robot`         the robot's limits, its motion, the compiled arc and limiter     01, 04
- `maps`          grid maps: distance fields, rays, files                          02, 05
- `fuzzy`         membership, rules, inference, rule bases as files                03
- `world`         obstacles and what moves among them                              01, 06
- `sensors`       encoders, sonar, laser, cameras                                  01
- `localization`  Kalman and particle filters                                      02
- `mapping`       occupancy maps from laser logs, pose graphs                      02
- `planning`      A* and its peers on grids, visibility, sampling                  05
- `smoothing`     fewer nodes, B-splines, eta curves                               05
- `simulate`      the closed loop and the record of a run                          04, 06
- `tracking`      references and the laws that follow them                         04
- `dwa`           the dynamic window approach, its weights chosen by fuzzy rules   06
- `blend`         tracking and avoidance blended by a fuzzy weight                 08
- `fusion`        a global path, a window among moving obstacles, and what keeps them safe  07
- `potential`     forces that lead to a goal, what traps them, and what frees them              09
- `evolve`        an evolution strategy that tunes numbers                         06, 10
- `studies`       the experiments behind the comparisons, by topic
- `published`     published against reproduced
- `plot`          every figure
- `benchmark`     planners compared over a set of tasks, a user's own among them  07
- `lab`           sliders and players
- `course`        exercises, hints, solutions, handout and grading
- `stale`, `warm` compiled kernels: forgotten when a source changed, made anew
"""

from fuzzynav.stale import forget_stale

__version__ = "0.1.0"

forget_stale()  # what a reader changes is what runs
del forget_stale
