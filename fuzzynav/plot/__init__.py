"""Every picture of the course; one module for each topic, all reached as `plot.<name>`."""

from fuzzynav.plot.base import *
from fuzzynav.plot.blit import *
from fuzzynav.plot.dwa import *
from fuzzynav.plot.dwa_diagrams import *
from fuzzynav.plot.dwa_labs import *
from fuzzynav.plot.fusion import *
from fuzzynav.plot.fusion_labs import *
from fuzzynav.plot.fuzzy import *
from fuzzynav.plot.fuzzy_labs import *
from fuzzynav.plot.map_labs import *
from fuzzynav.plot.maps import *
from fuzzynav.plot.planning import *
from fuzzynav.plot.planning_labs import *
from fuzzynav.plot.sensor_labs import *
from fuzzynav.plot.sensors import *
from fuzzynav.plot.start import *
from fuzzynav.plot.tracking import *
from fuzzynav.plot.tracking_labs import *
