#include "pipeline/command_line.h"

int main(int argc, char** argv) { return sunder::pipeline::command_line(argc, argv); }
