// coin_counts FILE POINTS TRIANGLES ...: reads each file with Coin's SoDB and compares what a render
// traversal would draw; "-" stands for any count. Points are the different positions among the corners of
// triangles. coin_counts binary IN OUT: writes what Coin reads again, in Inventor's binary form.
#include <array>
#include <cstdlib>
#include <iostream>
#include <set>
#include <string>

#include <Inventor/SoDB.h>
#include <Inventor/SoPrimitiveVertex.h>
#include <Inventor/actions/SoCallbackAction.h>
#include <Inventor/actions/SoWriteAction.h>
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

SoSeparator* read(const std::string& file) {
  SoInput input;
  return input.openFile(file.c_str()) ? SoDB::readAll(&input) : nullptr;
}

int write_binary(const std::string& in, const std::string& out) {
  SoSeparator* scene = read(in);
  SoOutput output;
  if (scene == nullptr || !output.openFile(out.c_str())) return EXIT_FAILURE;
  scene->ref();
  output.setBinary(TRUE);
  SoWriteAction(&output).apply(scene);
  output.closeFile();
  scene->unref();
  return EXIT_SUCCESS;
}

}  // namespace

int main(int count, char** arguments) {
  SoDB::init();
  if (count == 4 && arguments[1] == std::string("binary")) return write_binary(arguments[2], arguments[3]);
  int bad = 0;
  for (int i = 1; i + 2 < count; i += 3) {
    const std::string file = arguments[i], points = arguments[i + 1], triangles = arguments[i + 2];
    SoSeparator* scene = read(file);
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
