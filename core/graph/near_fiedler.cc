#include "core/graph/near_fiedler.h"

#include "core/graph/approximate_cholesky.h"
#include "core/graph/sparsify.h"

namespace mapweld {

FiedlerIteration near_fiedler(int vertices, std::span<const LaplacianEdge> edges, const Eigen::VectorXd& start,
                              const NearFiedlerOptions& options) {
  FiedlerIterationOptions iteration;
  iteration.tolerance = 1e-6;
  iteration.least_progress = options.least_progress;
  iteration.max_iterations = options.max_iterations;
  return iterate_to_fiedler(vertices, edges,
                            ApproximateCholesky(vertices, sparsify(vertices, edges, options.oversampling)), start,
                            iteration);
}

}  // namespace mapweld
