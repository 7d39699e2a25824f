"""Every picture of the course; one module for each topic, all reached as `plot.<name>`."""

from fuzzynav.plot.base import *
from fuzzynav.plot.benchmark import *
from fuzzynav.plot.blend import *
from fuzzynav.plot.blit import *
from fuzzynav.plot.dwa import *
from fuzzynav.plot.fusion import *
from fuzzynav.plot.fuzzy import *
from fuzzynav.plot.labs.blend import *
from fuzzynav.plot.labs.dwa import *
from fuzzynav.plot.labs.fusion import *
from fuzzynav.plot.labs.fuzzy import *
from fuzzynav.plot.labs.maps import *
from fuzzynav.plot.labs.planning import *
from fuzzynav.plot.labs.sensors import *
from fuzzynav.plot.labs.start import *
from fuzzynav.plot.labs.tracking import *
from fuzzynav.plot.maps import *
from fuzzynav.plot.navigation import *
from fuzzynav.plot.planning import *
from fuzzynav.plot.potential import *
from fuzzynav.plot.runs import *
from fuzzynav.plot.sensors import *
from fuzzynav.plot.tracking import *
