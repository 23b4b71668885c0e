#include "decimation/vertex_removals.h"

#include "decimation/legality/criteria.h"
#include "decimation/order/collapse_queues.h"
#include "decimation/run_removals.h"
#include "decimation/runs.h"

namespace vkmesh::detail {

template <bool kAttributes>
Result<Outcome> run_vertex_removals(DecimationState& state, bool exact, const Progress& progress) {
  if (exact || (state.criteria != nullptr && state.criteria->ranks()))
    return run_removals<VertexRemovals<ExactQueue, kAttributes>>(state, progress);
  return run_removals<VertexRemovals<LazyQueue, kAttributes>>(state, progress);
}

template Result<Outcome> run_vertex_removals<false>(DecimationState&, bool, const Progress&);
template Result<Outcome> run_vertex_removals<true>(DecimationState&, bool, const Progress&);

}  // namespace vkmesh::detail
