#include "decimation/main_loop.h"

namespace vkmesh::detail {

template Result<Outcome> remove_cheapest<false>(DecimationState&, DecimateOperation);

}  // namespace vkmesh::detail
