#include "cli/command_line.h"

int main(int argc, char** argv) { return sunder::cli::command_line(argc, argv); }
