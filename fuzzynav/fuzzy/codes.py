"""The numbers by which the compiled kernels know shapes, operators and defuzzifiers, and the columns of flat tables.

A kernel compiled by `njit` holds them as constants. `membership.SHAPES`, `operators` and `variable` give each its name.
"""

# shapes of sets
(
    TRIANGLE, TRAPEZOID, GAUSSIAN, TWO_SIDED_GAUSSIAN, BELL, SIGMOID, SIGMOID_DIFFERENCE, SIGMOID_PRODUCT, Z, S, PI,
    RAMP, RECTANGLE, SINGLETON, BINARY, CONSTANT, LINEAR, DISCRETE, SPIKE, COSINE, CONCAVE, ARC, SEMI_ELLIPSE,
) = range(23)  # fmt: skip

# conjunctions, disjunctions, hedges
MIN, PRODUCT, BOUNDED_DIFFERENCE, DRASTIC, EINSTEIN, HAMACHER, NILPOTENT_MINIMUM = range(7)
(
    MAX, PROBABILISTIC_SUM, BOUNDED_SUM, SUM, NORMALIZED_SUM, DRASTIC_SUM, EINSTEIN_SUM, HAMACHER_SUM,
    NILPOTENT_MAXIMUM,
) = range(9)  # fmt: skip
NOT, VERY, SOMEWHAT, EXTREMELY, SELDOM, ANY = range(6)
NO_HEDGE = -1

# ways from a set to a number, and how its integrals are taken
(
    CENTROID, BISECTOR, MEAN_OF_MAXIMUM, SMALLEST_OF_MAXIMUM, LARGEST_OF_MAXIMUM, WEIGHTED_AVERAGE, WEIGHTED_SUM,
) = range(7)  # fmt: skip
TRAPEZOID_RULE, MIDPOINTS, PLAIN_SUM, EXACT = range(4)

# instructions of an antecedent's program: (operation, operand, norm), or (AND_OF_THREE, three operands, rule)
LOAD, AND_NEXT, OR_NEXT, AND_TOP, OR_TOP, STORE, AND_OF_THREE = range(7)

# columns of the tables (see `compiled`)
LOW, HIGH, LOCKED = range(3)  # ranges
SHAPE, OWNER, FIRST, PAIRS = range(4)  # terms; FIRST is where its list begins
HEIGHT = 4  # numbers, after up to four parameters
TERM, FIRST_HEDGE = 0, 1  # propositions
RULE, SET, FIRST_CONCLUSION_HEDGE = range(3)  # consequents
SLOT_OUTPUT, SLOT_TERM, IMPLICATION, MERGE = range(4)  # slots
FIRST_SET, SETS, AGGREGATION, DEFUZZIFIER, QUADRATURE, SAMPLES = range(6)  # outputs
PLACES, WEIGHTS, FIRST_ROW = range(3)  # rows of a sampled output: places, weights, then the sets
