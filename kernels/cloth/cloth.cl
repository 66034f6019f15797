// All kernels of this folder as one program.
#include "cloth/open_folds.cl"
#include "cloth/simulate.cl"
