"""The steps from inputs to the numbers of a shot; what people look at comes after them."""
