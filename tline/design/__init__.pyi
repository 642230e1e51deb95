from tline.design.closure import closure as closure
from tline.design.columns import Peak as Peak
from tline.design.columns import Separation as Separation
from tline.design.columns import separation as separation
from tline.design.protection import flywheel as flywheel
from tline.design.protection import relief as relief
from tline.design.protection import vessel as vessel
from tline.design.sizing import Sizing as Sizing
