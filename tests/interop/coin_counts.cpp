// coin_counts FILE POINTS TRIANGLES ...: reads each file with Coin's SoDB and compares what a render
// traversal would draw; "-" stands for any count. Points are the different positions among the corners of
// triangles.
#include <array>
#include <cstdlib>
#include <iostream>
#include <set>
#include <string>

#include <Inventor/SoDB.h>
#include <Inventor/SoPrimitiveVertex.h>
#include <Inventor/actions/SoCallbackAction.h>
#include <Inventor/nodes/SoSeparator.h>
#include <Inventor/nodes/SoShape.h>

namespace {

struct Counts {
  std::size_t triangles = 0;
  std::set<std::array<float, 3>> points;
};

void on_triangle(void* data, SoCallbackAction* action, const SoPrimitiveVertex* a, const SoPrimitiveVertex* b,
                 const SoPrimitiveVertex* c) {
  auto& counts = *static_cast<Counts*>(data);
  ++counts.triangles;
  for (const SoPrimitiveVertex* vertex : {a, b, c}) {
    SbVec3f p;
    action->getModelMatrix().multVecMatrix(vertex->getPoint(), p);
    counts.points.insert({p[0], p[1], p[2]});
  }
}

}  // namespace

int main(int count, char** arguments) {
  SoDB::init();
  int bad = 0;
  for (int i = 1; i + 2 < count; i += 3) {
    const std::string file = arguments[i], points = arguments[i + 1], triangles = arguments[i + 2];
    SoInput input;
    SoSeparator* scene = input.openFile(file.c_str()) ? SoDB::readAll(&input) : nullptr;
    Counts counts;
    if (scene != nullptr) {
      scene->ref();
      SoCallbackAction action;
      action.addTriangleCallback(SoShape::getClassTypeId(), on_triangle, &counts);
      action.apply(scene);
      scene->unref();
    }
    if (scene != nullptr && (points == "-" || std::to_string(counts.points.size()) == points) &&
        (triangles == "-" || std::to_string(counts.triangles) == triangles))
      continue;
    ++bad;
    std::cerr << "Coin: " << file << ": ";
    if (scene != nullptr)
      std::cerr << counts.points.size() << " points and " << counts.triangles << " triangles, expected "
                << points << " and " << triangles << "\n";
    else
      std::cerr << "not read\n";
  }
  return bad > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
