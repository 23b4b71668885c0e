#include "decimation/edge_collapse_runs.h"

namespace vkmesh::detail {

template Result<Outcome> run_edge_collapses<true>(DecimationState&, const DecimateOptions&, bool,
                                                  const Progress&);

}  // namespace vkmesh::detail
