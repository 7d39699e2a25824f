# Solutions of chapter 05, first part: each block replaces the cell of its exercise.

# %% 05.1
def heuristic(dx, dy):
    """Length [cells] that no path by dx, dy can undercut."""
    long, short = max(abs(dx), abs(dy)), min(abs(dx), abs(dy))
    return (long - short) + np.sqrt(2) * short

# %% 05.2
def legal(occupied, x, y, dx, dy):
    """Whether the step (dx, dy) from the free cell (x, y) is allowed with strict corners."""
    rows, cols = occupied.shape
    if not (0 <= x + dx < cols and 0 <= y + dy < rows) or occupied[y + dy, x + dx]:
        return False
    return not (dx and dy and (occupied[y, x + dx] or occupied[y + dy, x]))

# %% 05.3
def cost(g_parent, parent, child, start):
    """Cost of a child that is reached from its parent."""
    return g_parent + np.hypot(child[0] - parent[0], child[1] - parent[1])

# %% 05.4
my_options = replace(astar.OPTIMAL, weight=1.2)
