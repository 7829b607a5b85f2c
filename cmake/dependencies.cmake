# Third-party libraries, each as one imported target. All come from Debian 12 (packages.txt).
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(assimp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_path(CEREAL_INCLUDE cereal/cereal.hpp REQUIRED)
find_package(PkgConfig REQUIRED)

set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE TRUE)
find_package(CGAL REQUIRED)
# CGAL asks whether arithmetic rounds as told whenever a program starts. Under valgrind, which counts instructions for a test, it does
# not, and the answer would end the program: tests/geometry/predicates_test.cpp asks instead.
target_compile_definitions(CGAL INTERFACE CGAL_DISABLE_ROUNDING_MATH_CHECK)

# Debian's FindOpenVDB asks for Boost parts that the library itself does not need.
pkg_check_modules(IMATH REQUIRED IMPORTED_TARGET Imath)
find_library(OPENVDB_LIBRARY openvdb REQUIRED)
find_path(OPENVDB_INCLUDE openvdb/openvdb.h REQUIRED)
add_library(OpenVDB INTERFACE)
target_link_libraries(OpenVDB INTERFACE ${OPENVDB_LIBRARY} TBB::tbb PkgConfig::IMATH)
target_include_directories(OpenVDB SYSTEM INTERFACE ${OPENVDB_INCLUDE})

# The float64 build of Bullet has no CMake config of its own; pkg-config names its libraries and its precision switch.
pkg_check_modules(BULLET REQUIRED IMPORTED_TARGET bullet-float64)
add_library(Bullet::float64 ALIAS PkgConfig::BULLET)

find_library(VORO_LIBRARY voro++ REQUIRED)
find_path(VORO_INCLUDE voro++/voro++.hh REQUIRED)
add_library(voro++ INTERFACE)
target_link_libraries(voro++ INTERFACE ${VORO_LIBRARY})
target_include_directories(voro++ SYSTEM INTERFACE ${VORO_INCLUDE})

find_path(TINYGLTF_INCLUDE tiny_gltf.h REQUIRED)
add_library(TinyGLTF INTERFACE)
target_include_directories(TinyGLTF SYSTEM INTERFACE ${TINYGLTF_INCLUDE})

find_package(PNG REQUIRED)
pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
pkg_check_modules(CRYPTO REQUIRED IMPORTED_TARGET libcrypto)
pkg_check_modules(SQLITE REQUIRED IMPORTED_TARGET sqlite3)
find_library(EMBREE_LIBRARY embree3 REQUIRED)
find_path(EMBREE_INCLUDE embree3/rtcore.h REQUIRED)
add_library(Embree INTERFACE)
target_link_libraries(Embree INTERFACE ${EMBREE_LIBRARY})
target_include_directories(Embree SYSTEM INTERFACE ${EMBREE_INCLUDE})
