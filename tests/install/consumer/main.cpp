#include <hewer/simplify.h>
#include <iostream>

int main(int argc, char** argv) {
    if (argc != 3) return 2;  // an input and an output
    hewer::SimplifyOptions options;
    options.targets = {{hewer::Target::Kind::Triangles, 100'000}};
    const auto report = hewer::simplify_file(argv[1], argv[2], options);
    std::cout << report.lods[0].triangles << " triangles\n";
}
