#include <Fulcrum/Collision/Shapes/EmptyShape.h>

namespace fulcrum {

std::shared_ptr<const EmptyShape> EmptyShape::Create() {
    const std::shared_ptr<EmptyShape> shape(new EmptyShape);
    shape->mass_.volume = 1;
    shape->mass_.principalInertia = Vector3::Constant(0.153932f);  // 2/5 (3 / (4 pi))^(2/3)
    shape->bounds_.Include(Vector3(Vector3::Zero()));
    return shape;
}

}  // namespace fulcrum
