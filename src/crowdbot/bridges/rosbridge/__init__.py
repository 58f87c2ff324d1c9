"""rosbridge: the JSON protocol of rosbridge_suite over WebSocket, as a server and as a client."""
